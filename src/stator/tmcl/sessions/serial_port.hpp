#pragma once

#include <cstddef>
#include <span>

#include "stator/base/sim_time.hpp"

namespace stator::tmcl {

/// The line behind a serial interface of a device: the virtual port of a USB cable, RS-232, RS-485.
/// A device asks for bytes and sends some; what carries them is not its business.
class SerialPort {
 public:
  SerialPort() = default;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  virtual ~SerialPort() = default;

  /// Moves bytes that came into `buffer`, in their order; returns how many. Never waits; costs next
  /// to nothing when none came.
  [[nodiscard]] virtual std::size_t take(std::span<std::byte> buffer) = 0;
  /// Sends all of `bytes` or drops them. `now`: where the device is in simulated time, which may
  /// lie before the moment to which somebody is bringing it.
  virtual void send(std::span<const std::byte> bytes, base::SimTime now) = 0;
};

}  // namespace stator::tmcl
