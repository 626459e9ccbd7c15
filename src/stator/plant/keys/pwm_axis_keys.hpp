#pragma once

#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/settings/key.hpp"

namespace stator::plant {

/// The table of one axis whose PWM periods are simulated, docs/rack-file.md. The device that makes
/// the PWM sets inverter.pwm_frequency before the table is read: the longest dead time follows from
/// it.
extern const settings::Section<PwmAxisParameters> kPwmAxisKeys;

}  // namespace stator::plant
