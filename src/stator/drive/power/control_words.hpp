#pragma once

#include <cstdint>

namespace stator::drive {

/// Bits of the controlword 6040h (CiA 402-2 §8.4.2).
namespace controlword {
inline constexpr std::uint16_t kSwitchOn = 1U << 0;
inline constexpr std::uint16_t kEnableVoltage = 1U << 1;
inline constexpr std::uint16_t kQuickStop = 1U << 2;  ///< active low
inline constexpr std::uint16_t kEnableOperation = 1U << 3;
inline constexpr std::uint16_t kNewSetPoint = 1U << 4;  ///< pp
inline constexpr std::uint16_t kHomingStart = 1U << 4;  ///< hm
inline constexpr std::uint16_t kRelative = 1U << 6;     ///< pp
inline constexpr std::uint16_t kFaultReset = 1U << 7;
inline constexpr std::uint16_t kHalt = 1U << 8;
}  // namespace controlword

/// Bits of the statusword 6041h (CiA 402-2 §8.4.3); 14 and 15 are the manufacturer's.
namespace statusword {
inline constexpr std::uint16_t kVoltageEnabled = 1U << 4;
inline constexpr std::uint16_t kWarning = 1U << 7;
inline constexpr std::uint16_t kRemote = 1U << 9;
inline constexpr std::uint16_t kTargetReached = 1U << 10;  ///< pp, pv, tq, hm
inline constexpr std::uint16_t kInternalLimit = 1U << 11;
inline constexpr std::uint16_t kSetPointAcknowledge = 1U << 12;  ///< pp
inline constexpr std::uint16_t kHomeAttained = 1U << 12;         ///< hm
inline constexpr std::uint16_t kTargetUsed = 1U << 12;           ///< csp, csv, cst
inline constexpr std::uint16_t kSpeedZero = 1U << 12;            ///< pv
inline constexpr std::uint16_t kFollowingError = 1U << 13;       ///< csp
inline constexpr std::uint16_t kHomingError = 1U << 13;          ///< hm
inline constexpr std::uint16_t kMotorActivity = 1U << 14;        ///< 1 = rotates
inline constexpr std::uint16_t kNegativeDirection = 1U << 15;  ///< 1 = negative, also the last one
}  // namespace statusword

}  // namespace stator::drive
