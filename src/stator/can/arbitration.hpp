// Which of two CAN frames wins the bus (ISO 11898-1 §8.4.2.3 and §10.9), and the masks of base and
// extended identifiers.
#pragma once

#include <cstdint>

#include "stator/can/frame.hpp"

namespace stator::can {

inline constexpr std::uint32_t kBaseIdentifierMask = 0x7FF;
inline constexpr std::uint32_t kExtendedIdentifierMask = 0x1FFF'FFFF;

/// The bits by which frames compete for the bus, in the order in which they are sent, recessive as
/// 1: of two frames that begin at the same bit the one with the smaller number wins
/// (ISO 11898-1 §8.4.2.3 and §10.9).
///
/// Base:     identifier (11)        RTR  IDE = 0
/// Extended: identifier 28-18 (11)  SRR = 1  IDE = 1  identifier 17-0 (18)  RTR
[[nodiscard]] constexpr std::uint32_t arbitration_field(const Frame& frame) {
  const std::uint32_t remote = frame.remote ? 1 : 0;
  if (!frame.extended) {
    return (frame.identifier & kBaseIdentifierMask) << 21U | remote << 20U;
  }
  const std::uint32_t identifier = frame.identifier & kExtendedIdentifierMask;
  return identifier >> 18U << 21U | 0b11U << 19U | (identifier & 0x3'FFFFU) << 1U | remote;
}

}  // namespace stator::can
