// A board at scripted pins with SPI and I2C masters that make the edges, for tests of peripherals.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "board/script_pins.hpp"
#include "stator/board/assembly/board.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

using namespace base::literals;

inline constexpr Line kSckLine = 0;
inline constexpr Line kMosiLine = 1;
inline constexpr Line kMisoLine = 2;
inline constexpr Line kCsLine = 3;
inline constexpr Line kSclLine = 4;
inline constexpr Line kSdaLine = 5;

/// A peripheral of a type with its pins, numbers and connections.
inline PeripheralConfiguration part(
    const char* name, const PeripheralType& type,
    std::initializer_list<std::pair<const char*, unsigned>> pins,
    std::initializer_list<std::pair<const char*, double>> numbers = {},
    std::initializer_list<std::pair<const char*, const char*>> connections = {}) {
  PeripheralConfiguration result(name, type);
  for (const auto& [pin, line] : pins) {
    result.wire(pin, line);
  }
  for (const auto& [parameter, value] : numbers) {
    result.settings.set(parameter, value);
  }
  for (const auto& [connection, other] : connections) {
    result.connect(connection, other);
  }
  return result;
}

/// A board at scripted pins, with masters that make their edges.
class Bench {
 public:
  explicit Bench(std::vector<PeripheralConfiguration> parts)
      : board(BoardConfiguration{std::move(parts)}, pins, base::SimTime()) {
    pins.put(base::SimTime(), kCsLine, Drive::high);
  }

  ScriptPins pins;
  Board board;

  void wait(base::SimDuration time) { board.advance(board.time() + time); }
  void set(Line line, bool level) {
    pins.put(board.time(), line, driven(level));
    board.advance(board.time());
  }
  [[nodiscard]] double signal(const std::string& name) {
    for (const base::Signal& signal : board.signals()) {
      if (signal.name == name) {
        return signal.read();
      }
    }
    throw std::runtime_error("no signal " + name);
  }
  void input(const std::string& name, double value) {
    for (const base::Input& input : board.inputs()) {
      if (input.name == name) {
        input.set(value);
        board.advance(board.time());
        return;
      }
    }
    throw std::runtime_error("no input " + name);
  }

  // An SPI master in mode 0 with a clock of 1 MHz.
  void select(bool active) {
    set(kCsLine, !active);
    wait(500_ns);
  }
  std::uint64_t clock(std::uint64_t sent, unsigned bits) {
    std::uint64_t received = 0;
    for (unsigned k = bits; k-- > 0;) {
      set(kMosiLine, ((sent >> k) & 1U) != 0);
      wait(500_ns);
      received = received << 1U | (pins.level(kMisoLine) ? 1U : 0U);
      set(kSckLine, true);
      wait(500_ns);
      set(kSckLine, false);
    }
    return received;
  }
  std::uint64_t spi(std::uint64_t sent, unsigned bits) {
    select(true);
    const std::uint64_t received = clock(sent, bits);
    select(false);
    return received;
  }

  // An I2C master of 100 kHz.
  void i2c_start() {
    release(kSdaLine);
    release(kSclLine);
    pull(kSdaLine);
    pull(kSclLine);
  }
  void i2c_stop() {
    pull(kSdaLine);
    release(kSclLine);
    release(kSdaLine);
  }
  /// True: acknowledged.
  bool i2c_write(std::uint8_t data) {
    for (unsigned k = 8; k-- > 0;) {
      i2c_bit(((data >> k) & 1U) != 0);
    }
    return !i2c_bit(true);
  }
  std::uint8_t i2c_read(bool acknowledge) {
    std::uint8_t data = 0;
    for (unsigned k = 0; k < 8; ++k) {
      data = static_cast<std::uint8_t>(unsigned{data} << 1U | (i2c_bit(true) ? 1U : 0U));
    }
    i2c_bit(!acknowledge);
    return data;
  }

 private:
  void release(Line line) {
    pins.put(board.time(), line, Drive::released);
    board.advance(board.time());
    wait(2500_ns);
  }
  void pull(Line line) {
    pins.put(board.time(), line, Drive::low);
    board.advance(board.time());
    wait(2500_ns);
  }
  bool i2c_bit(bool level) {
    level ? release(kSdaLine) : pull(kSdaLine);
    release(kSclLine);
    const bool seen = pins.level(kSdaLine);
    pull(kSclLine);
    return seen;
  }
};

}  // namespace stator::board
