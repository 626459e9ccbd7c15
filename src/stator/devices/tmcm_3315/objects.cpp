#include "stator/devices/tmcm_3315/objects.hpp"

#include <array>
#include <string_view>

#include "stator/devices/tmcm_3315/object_groups.hpp"

namespace stator::devices::tmcm_3315 {

namespace {
constexpr std::array<std::string_view, kAxisCount> kAxisPrefix{"Axis 0: ", "Axis 1: ", "Axis 2: "};
}  // namespace

void add_objects(dictionary::Dictionary& dictionary, FirmwareVersion firmware) {
  add_communication_objects(dictionary, firmware);
  for (std::uint8_t axis = 0; axis < kAxisCount; ++axis) {
    const auto offset = [axis](std::uint16_t step) {
      return static_cast<std::uint16_t>(axis * step);
    };
    const dictionary::Placement manufacturer{axis, offset(kManufacturerAxisOffset),
                                             kAxisPrefix[axis]};
    add_axis_motion_objects(dictionary, manufacturer, firmware);
    add_axis_driver_objects(dictionary, manufacturer);
    const dictionary::Placement profile{axis, offset(kProfileAxisOffset), kAxisPrefix[axis]};
    add_profile_drive_objects(dictionary, profile, firmware);
    add_profile_motion_objects(dictionary, profile);
  }
  add_module_objects(dictionary);
  dictionary.finish();
}

}  // namespace stator::devices::tmcm_3315
