#pragma once

#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"
#include "stator/plant/power/inverter.hpp"
#include "stator/plant/sensors/hall_sensors.hpp"
#include "stator/settings/key.hpp"

namespace stator::plant {

/// The table of one servo axis, docs/rack-file.md.
extern const settings::Section<ServoAxisParameters> kServoAxisKeys;

// Tables below that of an axis which axes of other kinds have as well.
extern const settings::Section<ThreePhaseMotorParameters> kThreePhaseMotorKeys;
/// All of an inverter but its PWM frequency, which must be known before they are read.
extern const settings::Section<InverterParameters> kHalfBridgeKeys;
extern const settings::Section<HallSensorParameters> kHallKeys;

}  // namespace stator::plant
