#pragma once

#include <cstring>
#include <optional>

#include <linux/can.h>
#include <linux/can/error.h>

#include "stator/can/frame.hpp"
#include "stator/link/can/can_error_frame.hpp"

// Frames as Linux has them.
namespace stator::link {

[[nodiscard]] inline can_frame to_socketcan(const can::Frame& frame) {
  can_frame result{};
  result.can_id =
      frame.identifier | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  result.can_dlc = frame.length;
  std::memcpy(result.data, frame.data.data(), frame.payload().size());
  return result;
}

[[nodiscard]] inline can_frame to_socketcan(const ErrorFrame& error) {
  can_frame result{};
  result.can_id = CAN_ERR_FLAG | error.classes;
  result.can_dlc = CAN_ERR_DLC;
  std::memcpy(result.data, error.data.data(), error.data.size());
  return result;
}

/// Nothing if it is an error frame or none that can be on a bus.
[[nodiscard]] inline std::optional<can::Frame> from_socketcan(const can_frame& frame) {
  if ((frame.can_id & CAN_ERR_FLAG) != 0 || frame.can_dlc > CAN_MAX_DLEN) {
    return std::nullopt;
  }
  can::Frame result;
  result.extended = (frame.can_id & CAN_EFF_FLAG) != 0;
  result.identifier = frame.can_id & (result.extended ? CAN_EFF_MASK : CAN_SFF_MASK);
  result.remote = (frame.can_id & CAN_RTR_FLAG) != 0;
  result.length = frame.can_dlc;
  std::memcpy(result.data.data(), frame.data, result.payload().size());
  return result;
}

}  // namespace stator::link
