#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "stator/ethercat/controller/slave_controller_configuration.hpp"

namespace stator::ethercat {

/// The document that describes the registers of a controller.
enum class RegisterDocument : std::uint8_t { tmc8461, tmc8670 };

/// A slave controller as it is built into a device.
struct SlaveControllerPreset {
  std::string_view device;  ///< as rack files and commands name it
  std::string_view name;  ///< which reading of the device; the first one of a device is the default
  std::string_view summary;
  RegisterDocument document;
  SlaveControllerConfiguration configuration;
};

/// All presets; those of one device follow one another, its default first.
///
/// The TMC8670 has two: `document` has every register its datasheet describes, as a master written
/// by that datasheet expects. `silicon` lacks the parts that the feature table of the family
/// (TMC8461 datasheet L1945-L2085, column TMC8670) marks as not built: their registers read 0 and
/// ignore writes, and the working counter counts.
[[nodiscard]] std::span<const SlaveControllerPreset> slave_controller_presets();

/// The preset `name` of `device`, the device's default if `name` is empty; nullptr if there is
/// none.
[[nodiscard]] const SlaveControllerPreset* find_slave_controller_preset(std::string_view device,
                                                                        std::string_view name = {});

}  // namespace stator::ethercat
