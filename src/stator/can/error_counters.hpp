#pragma once

#include <algorithm>
#include <cstdint>

namespace stator::can {

/// Fault confinement of a controller (ISO 11898-1 §8.9 and §12.1.4).
enum class ErrorState : std::uint8_t { error_active, error_passive, bus_off };

/// The two error counters of a controller and the state that follows from them.
class ErrorCounters {
 public:
  [[nodiscard]] unsigned transmit() const { return transmit_; }
  [[nodiscard]] unsigned receive() const { return receive_; }
  [[nodiscard]] ErrorState state() const {
    if (transmit_ > kPassiveAbove + 128) {
      return ErrorState::bus_off;
    }
    return transmit_ > kPassiveAbove || receive_ > kPassiveAbove ? ErrorState::error_passive
                                                                 : ErrorState::error_active;
  }

  void transmitted() { transmit_ -= transmit_ > 0 ? 1U : 0U; }
  void received() {
    if (receive_ > kPassiveAbove) {
      receive_ = kPassiveAbove;
    } else if (receive_ > 0) {
      --receive_;
    }
  }
  void transmit_error() { transmit_ = std::min(transmit_ + 8, kBusOff); }
  /// `first`: it saw the error before the others, hence a dominant bit after its own error flag.
  void receive_error(bool first) { receive_ = std::min(receive_ + (first ? 9U : 1U), 255U); }

  void enter_error_passive() { transmit_ = std::max(transmit_, kPassiveAbove + 1); }
  void enter_bus_off() { transmit_ = kBusOff; }
  void reset() { transmit_ = receive_ = 0; }

 private:
  static constexpr unsigned kPassiveAbove = 127;
  static constexpr unsigned kBusOff = 256;

  unsigned transmit_ = 0;
  unsigned receive_ = 0;
};

}  // namespace stator::can
