#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/can/frame.hpp"

namespace stator::link {

/// Bits of ErrorFrame::classes (Linux, include/uapi/linux/can/error.h).
inline constexpr std::uint32_t kProtocolViolation = 0x008;
inline constexpr std::uint32_t kBusError = 0x080;

/// What a CAN controller tells its program of errors, in the form that SocketCAN has for it and
/// python-can, candump and Wireshark read: never a frame of the bus.
struct ErrorFrame {
  std::uint32_t classes = 0;
  std::array<std::byte, can::kMaximumData> data{};

  friend bool operator==(const ErrorFrame&, const ErrorFrame&) = default;
};

/// The error frame of an active error flag on the bus, whose cause is not told.
[[nodiscard]] inline ErrorFrame bus_error_frame() {
  return {.classes = kProtocolViolation | kBusError};
}

}  // namespace stator::link
