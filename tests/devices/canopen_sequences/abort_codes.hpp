#pragma once

#include <cstdint>

#include "devices/canopen_sequences/object_rules.hpp"

namespace stator::tests {

// SDO abort codes (CiA 301 §7.2.4.3.17).
inline constexpr std::uint32_t kToggle = 0x05030000;
inline constexpr std::uint32_t kTimeout = 0x05040000;
inline constexpr std::uint32_t kCommand = 0x05040001;
inline constexpr std::uint32_t kReadOnly = 0x06010002;
inline constexpr std::uint32_t kNoObject = 0x06020000;
inline constexpr std::uint32_t kNotMappable = 0x06040041;
inline constexpr std::uint32_t kPdoLength = 0x06040042;
inline constexpr std::uint32_t kLength = 0x06070010;
inline constexpr std::uint32_t kTooLong = 0x06070012;
inline constexpr std::uint32_t kTooShort = 0x06070013;
inline constexpr std::uint32_t kNoSubindex = 0x06090011;
inline constexpr std::uint32_t kRange = 0x06090030;
inline constexpr std::uint32_t kTooHigh = 0x06090031;
inline constexpr std::uint32_t kTooLow = 0x06090032;
inline constexpr std::uint32_t kCannotStore = 0x08000020;
inline constexpr std::uint32_t kDeviceState = 0x08000022;

/// Can only be read.
[[nodiscard]] inline bool readable_only(ObjectRule rule) {
  return rule == ObjectRule::constant || rule == ObjectRule::live || rule == ObjectRule::text ||
         rule == ObjectRule::error_register;
}

}  // namespace stator::tests
