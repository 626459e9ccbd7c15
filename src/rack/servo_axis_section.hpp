#pragma once

#include "plant/servo_axis.hpp"
#include "rack/toml_section.hpp"

namespace stator::rack {

/// Reads the table of one servo axis (docs/rack-file.md) over the values `parameters` has. Throws
/// RackFileError for unknown keys and values out of range.
void read_servo_axis(TomlSection& section, plant::ServoAxisParameters& parameters);

}  // namespace stator::rack
