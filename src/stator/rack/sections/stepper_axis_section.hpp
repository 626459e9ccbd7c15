#pragma once

#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads one [[segment.device.axis]] table (docs/rack-file.md) over the values `parameters` has.
/// Throws RackFileError for unknown keys and values out of range.
void read_stepper_axis(TomlSection& section, plant::StepperAxisParameters& parameters);

}  // namespace stator::rack
