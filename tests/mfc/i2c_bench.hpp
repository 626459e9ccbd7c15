#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mfc/recording_sink.hpp"
#include "stator/mfc/units/i2c_master.hpp"

namespace stator::mfc::testing {

using base::SimDuration;
using base::SimTime;

// I2C_CONTROL.
inline constexpr std::uint8_t kReceiveNack = 0x01;
inline constexpr std::uint8_t kReceiveAck = 0x02;
inline constexpr std::uint8_t kSendData = 0x04;
inline constexpr std::uint8_t kSendAddress = 0x08;
inline constexpr std::uint8_t kStop = 0x10;
inline constexpr std::uint8_t kStart = 0x20;

/// A memory of 8 KByte at an address, as the 24LC64 of the document's example.
class Memory : public I2cSlave {
 public:
  explicit Memory(std::uint8_t address) : address_(address) {}
  void start(SimTime /*time*/) override {
    log += 'S';
    written_ = 0;
  }
  I2cAnswer address(SimTime time, std::uint8_t address, bool read) override {
    log += read ? 'r' : 'w';
    asked_at = time;
    return {.acknowledge = address == address_, .stretch = stretch};
  }
  I2cAnswer write(SimTime /*time*/, std::uint8_t value) override {
    if (written_ < 2) {
      cursor_ = static_cast<std::uint16_t>(cursor_ << 8 | value);
    } else {
      bytes[cursor_++ % bytes.size()] = value;
    }
    ++written_;
    return {.acknowledge = value != 0xEE, .stretch = stretch};
  }
  I2cData read(SimTime /*time*/) override {
    return {.value = bytes[cursor_++ % bytes.size()], .stretch = stretch};
  }
  void acknowledged(SimTime /*time*/, bool acknowledge) override { log += acknowledge ? 'A' : 'N'; }
  void stop(SimTime /*time*/) override { log += 'P'; }

  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(8192);
  SimDuration stretch;
  SimTime asked_at;  ///< for the acknowledge of an address
  std::string log;

 private:
  std::uint8_t address_;
  std::uint16_t cursor_ = 0;
  int written_ = 0;
};

struct I2cBench {
  RecordingSink sink;
  I2cMaster unit;
  Memory memory{0x50};
  SimTime now;

  I2cBench() {
    unit.attach(memory);
    unit.watch({Signal::scl, Signal::sda});
    unit.write_timebase(10);
  }
  /// Gives a command and waits for its end; returns how long it took.
  SimDuration command(std::uint8_t bits) {
    const SimTime begin = now;
    unit.write_control(bits);
    while (unit.next_event() != SimTime::never()) {
      now = unit.next_event();
      unit.advance(now, sink);
    }
    return now - begin;
  }
  std::uint8_t address(std::uint8_t value) {
    unit.write_address(value);
    command(kSendAddress);
    return unit.status();
  }
  std::uint8_t data(std::uint8_t value) {
    unit.write_data(value);
    command(kSendData);
    return unit.status();
  }
};

/// What somebody on the two lines sees: S, P, and bits.
inline std::string on_the_wire(const std::vector<Edge>& edges) {
  bool scl = true, sda = true;
  std::string result;
  std::string bits;
  for (const Edge& edge : edges) {
    if (edge.signal == Signal::scl) {
      scl = edge.level;
      if (scl) {
        bits += sda ? '1' : '0';
      }
      if (bits.size() == 9 && !scl) {
        result += bits + ' ';
        bits.clear();
      }
    } else {
      if (scl) {
        result += edge.level ? "P " : "S ";
        bits.clear();
      }
      sda = edge.level;
    }
  }
  return result;
}

}  // namespace stator::mfc::testing
