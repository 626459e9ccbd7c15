#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tmcl/serial_port.hpp"
#include "tmcl/telegram.hpp"

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
  void send(std::span<const std::byte> bytes) override {
    from_device.insert(from_device.end(), bytes.begin(), bytes.end());
  }

  /// The first `length` bytes of a telegram go to the device.
  void put(const tmcl::Telegram& telegram, std::size_t length = tmcl::kTelegramLength) {
    to_device.insert(to_device.end(), telegram.begin(),
                     telegram.begin() + static_cast<std::ptrdiff_t>(length));
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

}  // namespace stator::tests
