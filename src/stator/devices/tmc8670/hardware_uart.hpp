#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"

namespace stator::devices::tmc8670 {

/// The UART into the FOC block's registers (L736-L781): datagrams of five bytes, an address with
/// the write bit, then 32 bits, most significant byte first; every one is answered. It is
/// hardware beside the processor: registers are reached between two PWM periods, whatever the
/// firmware does.
///
/// Bytes of a datagram must come within a second of its first byte; after a longer silence the next
/// byte begins a new one. UART_BPS, 79h, chooses the speed once the reply has been sent; a
/// value that is no speed changes nothing (F-82).
class HardwareUart {
 public:
  static constexpr std::size_t kDatagramLength = 5;
  static constexpr base::SimDuration kTimeOut{1'000'000'000};
  static constexpr std::uint32_t kDefaultBaudRate = 9600;

  /// `block` outlives the UART.
  explicit HardwareUart(control::foc::FocBlock& block) : block_(block) {}

  /// The line, or null: no cable.
  void connect(tmcl::SerialPort* port) { port_ = port; }
  /// The chip starts anew: 9600 bit/s, nothing received.
  void restart();
  /// Answers what has come by `now`.
  void serve(base::SimTime now);

  [[nodiscard]] std::uint32_t baud_rate() const { return baud_rate_; }

 private:
  void take(std::byte byte, base::SimTime now);
  void answer(base::SimTime now);
  void follow_speed(base::SimTime now);
  [[nodiscard]] base::SimDuration datagram_time() const;

  control::foc::FocBlock& block_;
  tmcl::SerialPort* port_ = nullptr;
  std::array<std::byte, kDatagramLength> datagram_{};
  std::size_t length_ = 0;  ///< bytes of it that have come
  base::SimTime begun_;     ///< when its first one did
  std::uint32_t baud_rate_ = kDefaultBaudRate;
  base::SimTime sent_;  ///< when the last reply is through
};

}  // namespace stator::devices::tmc8670
