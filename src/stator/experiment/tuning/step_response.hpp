#pragma once

#include "stator/experiment/tuning/verification.hpp"

namespace stator::experiment::tuning {

// Steps from rest, as high as current and voltage allow without limits. Each waits for the shaft to
// rest again.
[[nodiscard]] StepResponse measure_current_step(Chip& chip, const LoopDesign& design);
[[nodiscard]] StepResponse measure_velocity_step(Chip& chip, const LoopDesign& design,
                                                 const Mechanics& mechanics);
[[nodiscard]] StepResponse measure_position_step(Chip& chip, const LoopDesign& design);

/// Turns the rotor to where its magnets lie along phase U and holds it there by a current in that
/// direction, with the current loops closed: phase currents then keep their signs, so that dead
/// time cannot hide what the loops do, and the shaft stands. release() ends it.
void hold_along_phase(Chip& chip, const LoopDesign& design);
void release(Chip& chip, const LoopDesign& design);

}  // namespace stator::experiment::tuning
