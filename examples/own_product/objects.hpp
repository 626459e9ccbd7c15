#pragma once

#include <array>

#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/axis/error_report.hpp"

namespace own_product {

/// Declares the drive's own objects.
void add_objects(stator::dictionary::Dictionary& dictionary);

/// What errors of the axis do and what the master is told of them (CiA 402-2 annex A).
inline constexpr auto kErrors = [] {
  using enum stator::drive::AxisError;
  using enum stator::drive::ErrorReaction;
  return std::to_array<stator::drive::AxisEmergency>({
      {following_error, 0x8611, 0, 0x21, fault},
      {positive_software_limit, 0x8600, 1, 0x21, stop},
      {negative_software_limit, 0x8600, 2, 0x21, stop},
      {positive_limit_switch, 0x8600, 3, 0x21, stop},
      {negative_limit_switch, 0x8600, 4, 0x21, stop},
      {open_load_a, 0x3331, 0, 0x05, warning},
      {open_load_b, 0x3332, 0, 0x05, warning},
      {overcurrent_a, 0x2340, 1, 0x03, power_off},
      {overcurrent_b, 0x2340, 2, 0x03, power_off},
      {overcurrent_high_side, 0x2340, 0, 0x03, power_off},
      {over_temperature_warning, 0x4210, 0, 0x09, warning},
      {over_temperature, 0x4310, 0, 0x09, power_off},
      {undervoltage, 0x3220, 0, 0x05, power_off},
  });
}();

}  // namespace own_product
