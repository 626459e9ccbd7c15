#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "stator/tmcl/sessions/serial_port.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tests {

/// A serial line without a line: what a host has at its end of it.
class SerialLine final : public tmcl::SerialPort {
 public:
  std::size_t take(std::span<std::byte> buffer) override {
    const std::size_t length = std::min(buffer.size(), to_device.size());
    for (std::size_t i = 0; i < length; ++i) {
      buffer[i] = to_device.front();
      to_device.pop_front();
    }
    return length;
  }
  void send(std::span<const std::byte> bytes, base::SimTime /*now*/) override {
    from_device.insert(from_device.end(), bytes.begin(), bytes.end());
  }

  void write(std::span<const std::byte> bytes) {
    to_device.insert(to_device.end(), bytes.begin(), bytes.end());
  }
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// The first `length` bytes of a telegram go to the device.
  void put(const tmcl::Telegram& telegram, std::size_t length = tmcl::kTelegramLength) {
    write(std::span(telegram).first(length));
  }
  /// What the device sent since the last call.
  [[nodiscard]] std::vector<std::byte> read() {
    std::vector<std::byte> bytes;
    bytes.swap(from_device);
    return bytes;
  }
  [[nodiscard]] std::string read_text() {
    std::string text;
    for (const std::byte byte : read()) {
      text += static_cast<char>(byte);
    }
    return text;
  }
  /// The one telegram that came from the device; it is taken.
  tmcl::Telegram take_telegram() {
    tmcl::Telegram telegram{};
    EXPECT_EQ(from_device.size(), telegram.size());
    std::copy_n(from_device.begin(), std::min(from_device.size(), telegram.size()),
                telegram.begin());
    from_device.clear();
    return telegram;
  }

  std::deque<std::byte> to_device;
  std::vector<std::byte> from_device;
};

inline std::vector<std::byte> bytes_of(std::initializer_list<unsigned> values) {
  std::vector<std::byte> bytes;
  for (const unsigned value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

}  // namespace stator::tests
