#pragma once

#include <array>
#include <cstdint>

#include "stator/drive/axis/error_report.hpp"

namespace stator::devices::tmc8670 {

/// The chip's document has none of it (A-01, F-78).
inline constexpr auto kEmergencies = [] {
  using enum drive::AxisError;
  using enum drive::ErrorReaction;
  namespace bits = drive::error_register;
  return std::to_array<drive::AxisEmergency>({
      {following_error, 0x8611, 0, bits::kOfDeviceProfile, fault},
      {positive_software_limit, 0xFF01, 1, bits::kOfManufacturer, stop},
      {negative_software_limit, 0xFF01, 2, bits::kOfManufacturer, stop},
      {positive_limit_switch, 0xFF01, 3, bits::kOfManufacturer, stop},
      {negative_limit_switch, 0xFF01, 4, bits::kOfManufacturer, stop},
      {overcurrent_a, 0x2310, 1, bits::kOfCurrent, power_off},
      {overcurrent_b, 0x2310, 2, bits::kOfCurrent, power_off},
      {overcurrent_c, 0x2310, 3, bits::kOfCurrent, power_off},
      {overcurrent_high_side, 0x2310, 0, bits::kOfCurrent, power_off},
      {overload, 0x2350, 0, bits::kOfCurrent, fault},
      {overvoltage, 0x3210, 0, bits::kOfVoltage, power_off},
      {undervoltage, 0x3220, 0, bits::kOfVoltage, power_off},
      {over_temperature_warning, 0x4210, 1, bits::kOfTemperature, warning},
      {over_temperature, 0x4210, 2, bits::kOfTemperature, power_off},
      {shutdown_switch, 0x5441, 0, bits::kOfManufacturer, power_off},
      {stall, 0x7121, 0, bits::kOfDeviceProfile, stop},
      {initialisation_error, 0x7122, 0, bits::kOfDeviceProfile, power_off},
      {hall_error, 0x7310, 0, bits::kOfDeviceProfile, power_off},
      {driver_error, 0x5400, 0, bits::kOfManufacturer, power_off},
  });
}();

}  // namespace stator::devices::tmc8670
