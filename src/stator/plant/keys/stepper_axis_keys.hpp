#pragma once

#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/settings/key.hpp"

namespace stator::plant {

/// The table of one stepper axis, docs/rack-file.md.
extern const settings::Section<StepperAxisParameters> kStepperAxisKeys;

}  // namespace stator::plant
