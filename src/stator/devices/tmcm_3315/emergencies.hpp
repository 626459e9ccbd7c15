#pragma once

#include <array>
#include <cstdint>

#include "stator/drive/axis/error_report.hpp"

namespace stator::devices::tmcm_3315 {

/// The emergency table (document L3756-L3779). Which bits of 1001h (L418-L427) a code sets and
/// which errors lead to the Fault state the document leaves open; this table decides. Those of the
/// whole device are told once for all axes.
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
      {open_load_a, 0x1000, 1, bits::kGeneric, warning},
      {open_load_b, 0x1000, 2, bits::kGeneric, warning},
      {overcurrent_high_side, 0x2310, 0, bits::kOfCurrent, power_off},
      {overcurrent_b, 0x2311, 0, bits::kOfCurrent, power_off},
      {overcurrent_a, 0x2312, 0, bits::kOfCurrent, power_off},
      {stall, 0x3230, 0, bits::kOfDeviceProfile, stop},
      {over_temperature_warning, 0x4310, 1, bits::kOfTemperature, warning},
      {over_temperature, 0x4310, 2, bits::kOfTemperature, power_off},
      {shutdown_switch, 0x5441, 0, bits::kOfManufacturer, power_off, true},
      {undervoltage, 0xFF00, 0, bits::kOfVoltage, power_off},
  });
}();
static_assert(kEmergencies.size() == drive::kStepperErrorCount);

}  // namespace stator::devices::tmcm_3315
