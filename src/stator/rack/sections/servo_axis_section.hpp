#pragma once

#include "stator/plant/axes/servo_axis.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads the table of one servo axis (docs/rack-file.md) over the values `parameters` has. Throws
/// RackFileError for unknown keys and values out of range.
void read_servo_axis(TomlSection& section, plant::ServoAxisParameters& parameters);

// Tables below that of an axis which axes of other products have as well.
void read_three_phase_motor(TomlSection section, plant::ThreePhaseMotorParameters& motor);
/// All of an inverter but its PWM frequency; it switches with a period of `pwm_period` seconds.
void read_half_bridges(TomlSection& section, double pwm_period,
                       plant::InverterParameters& inverter);
void read_halls(TomlSection section, plant::HallSensorParameters& halls);

}  // namespace stator::rack
