// The node-IDs that a CANopen node may have.
#pragma once

#include <cstdint>

namespace stator::canopen {

inline constexpr std::uint8_t kMinimumNodeId = 1;
inline constexpr std::uint8_t kMaximumNodeId = 127;
/// A node-ID that is not configured: the node stays silent until LSS gives it one (CiA 305).
inline constexpr std::uint8_t kUnconfiguredNodeId = 0xFF;

[[nodiscard]] constexpr bool is_node_id(unsigned value) {
  return value >= kMinimumNodeId && value <= kMaximumNodeId;
}

}  // namespace stator::canopen
