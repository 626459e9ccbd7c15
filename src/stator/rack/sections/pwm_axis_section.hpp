#pragma once

#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads the table of one axis whose PWM periods are simulated (docs/rack-file.md) over the values
/// `parameters` has. Who makes the PWM begins with periods of `pwm_period` seconds. Throws
/// RackFileError for unknown keys and values out of range.
void read_pwm_axis(TomlSection& section, double pwm_period, plant::PwmAxisParameters& parameters);

}  // namespace stator::rack
