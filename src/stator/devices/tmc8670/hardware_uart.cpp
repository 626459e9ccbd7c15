#include "stator/devices/tmc8670/hardware_uart.hpp"

#include <algorithm>
#include <span>

namespace stator::devices::tmc8670 {

namespace {

using control::foc::field;

constexpr std::uint8_t kWriteBit = 0x80;
constexpr std::int64_t kBitsPerByte = 10;  // 8N1, L744
constexpr std::int64_t kSecond = 1'000'000'000;

/// Contents of UART_BPS, whose hexadecimal digits are read as decimal ones, and what they mean.
struct Speed {
  std::uint32_t digits;
  std::uint32_t baud_rate;
};
constexpr auto kSpeeds = std::to_array<Speed>({
    {0x00009600, 9600},
    {0x00115200, 115'200},
    {0x00921600, 921'600},
    {0x03000000, 3'000'000},
});

}  // namespace

void HardwareUart::restart() {
  length_ = 0;
  baud_rate_ = kDefaultBaudRate;
  sent_ = base::SimTime();
}

void HardwareUart::serve(base::SimTime now) {
  follow_speed(now);
  if (port_ == nullptr) {
    return;
  }
  std::array<std::byte, 64> buffer{};
  while (const std::size_t length = port_->take(buffer)) {
    for (const std::byte byte : std::span(buffer).first(length)) {
      take(byte, now);
    }
  }
}

void HardwareUart::take(std::byte byte, base::SimTime now) {
  if (length_ != 0 && now - begun_ > kTimeOut) {
    length_ = 0;
  }
  if (length_ == 0) {
    begun_ = now;
  }
  datagram_[length_++] = byte;
  if (length_ == kDatagramLength) {
    length_ = 0;
    answer(now);
  }
}

void HardwareUart::answer(base::SimTime now) {
  const auto first = std::to_integer<std::uint8_t>(datagram_[0]);
  const auto address = static_cast<std::uint8_t>(first & ~kWriteBit);
  std::uint32_t value = 0;
  for (const std::byte byte : std::span(datagram_).subspan(1)) {
    value = value << 8U | std::to_integer<std::uint32_t>(byte);
  }
  if ((first & kWriteBit) != 0) {
    static_cast<void>(block_.write(address, value));
  } else {
    value = block_.read(address);
    for (std::size_t i = 1; i < kDatagramLength; ++i) {
      datagram_[i] = static_cast<std::byte>(value >> (8 * (kDatagramLength - 1 - i)));
    }
  }
  sent_ = std::max(sent_, now) + datagram_time();
  port_->send(datagram_, now);
}

void HardwareUart::follow_speed(base::SimTime now) {
  if (now < sent_) {
    return;
  }
  const std::uint32_t digits = block_.read(field("UART_BPS").address);
  const auto* const speed = std::ranges::find(kSpeeds, digits, &Speed::digits);
  if (speed != kSpeeds.end()) {
    baud_rate_ = speed->baud_rate;
  }
}

base::SimDuration HardwareUart::datagram_time() const {
  constexpr std::int64_t kBits = kBitsPerByte * static_cast<std::int64_t>(kDatagramLength);
  return base::SimDuration((kBits * kSecond + baud_rate_ - 1) / baud_rate_);
}

}  // namespace stator::devices::tmc8670
