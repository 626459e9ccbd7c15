#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/drive/axis/axis_error.hpp"

namespace stator::devices::tmc8670 {

/// Bits of the error register 1001h (CiA 301 §7.5.2.2).
namespace error_register {
inline constexpr std::uint8_t kGeneric = 1U << 0;
inline constexpr std::uint8_t kCurrent = 1U << 1;
inline constexpr std::uint8_t kVoltage = 1U << 2;
inline constexpr std::uint8_t kTemperature = 1U << 3;
inline constexpr std::uint8_t kDeviceProfile = 1U << 5;
inline constexpr std::uint8_t kManufacturer = 1U << 7;
}  // namespace error_register

/// An error of the axis as a master sees it: code of emergency and 603Fh (CiA 402-2 annex A, where
/// it has one for the case), first additional byte, bits of 1001h, and what the drive does. The
/// chip's document has none of it (A-01, F-78).
struct Emergency {
  drive::AxisError error{};
  std::uint16_t code = 0;
  std::uint8_t detail = 0;
  std::uint8_t register_bits = 0;
  drive::ErrorReaction reaction{};
};

inline constexpr std::uint16_t kFaultReset = 0x0000;
/// A mapped object did not take its value from process data.
inline constexpr std::uint16_t kParameterError = 0x6320;

inline constexpr auto kEmergencies = [] {
  using enum drive::AxisError;
  using enum drive::ErrorReaction;
  namespace bits = error_register;
  constexpr std::uint8_t kProfileSpecific = bits::kGeneric | bits::kDeviceProfile;
  constexpr std::uint8_t kOfMaker = bits::kGeneric | bits::kManufacturer;
  constexpr std::uint8_t kOfCurrent = bits::kGeneric | bits::kCurrent;
  constexpr std::uint8_t kOfVoltage = bits::kGeneric | bits::kVoltage;
  constexpr std::uint8_t kOfTemperature = bits::kGeneric | bits::kTemperature;
  return std::to_array<Emergency>({
      {following_error, 0x8611, 0, kProfileSpecific, fault},
      {positive_software_limit, 0xFF01, 1, kOfMaker, stop},
      {negative_software_limit, 0xFF01, 2, kOfMaker, stop},
      {positive_limit_switch, 0xFF01, 3, kOfMaker, stop},
      {negative_limit_switch, 0xFF01, 4, kOfMaker, stop},
      {overcurrent_a, 0x2310, 1, kOfCurrent, power_off},
      {overcurrent_b, 0x2310, 2, kOfCurrent, power_off},
      {overcurrent_c, 0x2310, 3, kOfCurrent, power_off},
      {overcurrent_high_side, 0x2310, 0, kOfCurrent, power_off},
      {overload, 0x2350, 0, kOfCurrent, fault},
      {overvoltage, 0x3210, 0, kOfVoltage, power_off},
      {undervoltage, 0x3220, 0, kOfVoltage, power_off},
      {over_temperature_warning, 0x4210, 1, kOfTemperature, warning},
      {over_temperature, 0x4210, 2, kOfTemperature, power_off},
      {shutdown_switch, 0x5441, 0, kOfMaker, power_off},
      {stall, 0x7121, 0, kProfileSpecific, stop},
      {initialisation_error, 0x7122, 0, kProfileSpecific, power_off},
      {hall_error, 0x7310, 0, kProfileSpecific, power_off},
      {driver_error, 0x5400, 0, kOfMaker, power_off},
  });
}();

/// The reactions of the table, by AxisError.
constexpr drive::ErrorReactions error_reactions() {
  drive::ErrorReactions reactions{};
  for (const Emergency& row : kEmergencies) {
    reactions[static_cast<std::size_t>(row.error)] = row.reaction;
  }
  return reactions;
}

}  // namespace stator::devices::tmc8670
