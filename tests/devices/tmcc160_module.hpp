#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/base/event.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/dictionary/abort_code.hpp"

namespace stator::tests {

using devices::Tmcc160;
using devices::Tmcc160Configuration;
using product::Input;
using product::Signal;

/// A TMCC160 on a bus without delays, and the master at its other end.
class Tmcc160Module : public base::EventSink {
 public:
  using AbortCode = dictionary::AbortCode;
  static constexpr AbortCode kNoError{};

  explicit Tmcc160Module(const Tmcc160Configuration& configuration = {})
      : node_id(configuration.node_id),
        device(std::make_unique<Tmcc160>(configuration, base::EventReporter(this, 0))) {}

  void on_event(const base::Event& event) override {
    sentences.push_back(base::to_sentence(event));
  }

  /// Lets time pass in steps of a millisecond at most, and takes what is sent.
  void wait(double milliseconds) {
    const base::SimTime end = now + base::SimDuration(std::llround(1e6 * milliseconds));
    while (now < end) {
      now = std::min(end, now + base::SimDuration(1'000'000));
      device->advance(now);
      collect();
    }
  }
  /// Power-on, boot-up, and into Operational if asked for.
  void boot(bool operational = false) {
    wait(502);
    EXPECT_FALSE(frames.empty());
    EXPECT_EQ(frames.front(), can::data_frame(0x700U + node_id, {0}));
    frames.clear();
    if (operational) {
      nmt(1);
    }
  }
  void send(const can::Frame& frame) {
    device->controller().deliver(frame);
    device->handle_bus_events(now);
    collect();
  }
  void nmt(unsigned command) { send(can::data_frame(0x000, {command, node_id})); }

  /// One request and its answer; an empty answer if none came.
  std::vector<std::uint8_t> sdo(const std::array<std::uint8_t, 8>& request) {
    frames.clear();
    can::Frame frame{.identifier = 0x600U + node_id, .length = 8};
    for (std::size_t i = 0; i < 8; ++i) {
      frame.data[i] = std::byte{request[i]};
    }
    send(frame);
    for (int tries = 0; tries < 50; ++tries) {
      for (const can::Frame& answer : frames) {
        if (answer.identifier == 0x580U + node_id) {
          std::vector<std::uint8_t> bytes;
          for (const std::byte byte : answer.payload()) {
            bytes.push_back(std::to_integer<std::uint8_t>(byte));
          }
          return bytes;
        }
      }
      wait(1);
    }
    return {};
  }
  static std::array<std::uint8_t, 8> header(std::uint8_t command, std::uint16_t index,
                                            std::uint8_t subindex) {
    return {command, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(index >> 8),
            subindex};
  }

  /// Expedited download with the size of the entry.
  AbortCode write(std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
    const dictionary::Entry* entry = device->dictionary().find(index, subindex);
    const std::size_t size = entry == nullptr ? 4 : entry->size();
    auto request = header(static_cast<std::uint8_t>(0x23U | (4 - size) << 2), index, subindex);
    for (std::size_t i = 0; i < size; ++i) {
      request[4 + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
    return abort_of(sdo(request));
  }
  /// Any upload; the raw bytes. `abort` tells why there are none.
  std::vector<std::uint8_t> upload(std::uint16_t index, std::uint8_t subindex) {
    std::vector<std::uint8_t> answer = sdo(header(0x40, index, subindex));
    abort = abort_of(answer);
    if (abort != kNoError || answer.empty()) {
      return {};
    }
    if ((answer[0] & 2U) != 0) {
      const std::size_t unused = (answer[0] & 1U) != 0 ? answer[0] >> 2 & 3U : 0;
      return {answer.begin() + 4, answer.end() - static_cast<std::ptrdiff_t>(unused)};
    }
    std::vector<std::uint8_t> bytes;
    for (std::uint8_t toggle = 0;; toggle ^= 0x10U) {
      answer = sdo({static_cast<std::uint8_t>(0x60U | toggle)});
      if (answer.empty() || answer[0] == 0x80) {
        ADD_FAILURE() << "segmented upload broke";
        return bytes;
      }
      bytes.insert(bytes.end(), answer.begin() + 1,
                   answer.end() - static_cast<std::ptrdiff_t>(answer[0] >> 1 & 7U));
      if ((answer[0] & 1U) != 0) {
        return bytes;
      }
    }
  }
  std::int64_t read(std::uint16_t index, std::uint8_t subindex = 0) {
    const std::vector<std::uint8_t> bytes = upload(index, subindex);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size() && i < 8; ++i) {
      value |= std::uint64_t{bytes[i]} << (8 * i);
    }
    const dictionary::Entry* entry = device->dictionary().find(index, subindex);
    if (entry != nullptr && dictionary::is_signed(entry->type()) && !bytes.empty()) {
      const unsigned shift = 64U - 8U * static_cast<unsigned>(bytes.size());
      return static_cast<std::int64_t>(value << shift) >> shift;
    }
    return static_cast<std::int64_t>(value);
  }
  std::string read_text(std::uint16_t index) {
    const std::vector<std::uint8_t> bytes = upload(index, 0);
    return {bytes.begin(), bytes.end()};
  }
  static AbortCode abort_of(const std::vector<std::uint8_t>& answer) {
    if (answer.size() != 8) {
      return AbortCode::protocol_timeout;
    }
    if (answer[0] != 0x80) {
      return kNoError;
    }
    std::uint32_t code = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      code |= std::uint32_t{answer[4 + i]} << (8 * i);
    }
    return static_cast<AbortCode>(code);
  }

  void control(std::uint16_t word) { EXPECT_EQ(write(0x6040, 0, word), kNoError); }
  /// The bits of the statusword that code the state (CiA 402-2 table 29).
  unsigned state() {
    const auto word = static_cast<unsigned>(read(0x6041));
    return word & ((word & 0x48U) != 0 ? 0x4FU : 0x6FU);
  }
  /// Commands 6, 7, 15 in the mode; limit switches off unless `switches`.
  void enable(std::int8_t mode, bool switches = false) {
    EXPECT_EQ(write(0x2005, 0, switches ? 0 : 3), kNoError);
    EXPECT_EQ(write(0x6060, 0, mode), kNoError);
    for (const int word : {6, 7, 15}) {
      control(static_cast<std::uint16_t>(word));
      wait(3);
    }
    EXPECT_EQ(state(), 0x27U);
  }
  void set(const std::string& input, double value) {
    for (const Input& candidate : device->inputs()) {
      if (candidate.name == input) {
        candidate.set(value);
        return;
      }
    }
    ADD_FAILURE() << "no input " << input;
  }
  double signal(const std::string& name) {
    for (const Signal& candidate : device->signals()) {
      if (candidate.name == name) {
        return candidate.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }

  /// Emergencies taken so far, as hexadecimal bytes "10 23 03 00 ..."; forgets them.
  std::vector<std::string> take_emergencies() {
    std::vector<std::string> result;
    std::vector<can::Frame> others;
    for (const can::Frame& frame : all) {
      if (frame.identifier != 0x80U + node_id) {
        continue;
      }
      std::string text;
      for (const std::byte byte : frame.payload()) {
        constexpr std::string_view kDigits = "0123456789ABCDEF";
        const auto value = std::to_integer<unsigned>(byte);
        text += text.empty() ? "" : " ";
        text += kDigits[value >> 4];
        text += kDigits[value & 15U];
      }
      result.push_back(text);
    }
    all.clear();
    return result;
  }

  unsigned node_id;
  base::SimTime now;
  std::unique_ptr<Tmcc160> device;
  std::vector<can::Frame> frames;  ///< since the last SDO request
  std::vector<can::Frame> all;     ///< since the last take_emergencies()
  std::vector<std::string> sentences;
  AbortCode abort{};

 private:
  void collect() {
    can::Controller& controller = device->controller();
    while (const can::Frame* frame = controller.pending()) {
      const can::Frame copy = *frame;
      frames.push_back(copy);
      all.push_back(copy);
      controller.transmitted(copy);
    }
  }
};

}  // namespace stator::tests
