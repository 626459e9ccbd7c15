#pragma once

#include "stator/experiment/tuning/verification.hpp"

namespace stator::experiment::tuning {

/// The torque loop, with sines across the current that holds the shaft.
[[nodiscard]] BodePlot measure_current_response(Chip& chip, const LoopDesign& design);
/// The velocity loop, with sines about a third of the highest speed.
[[nodiscard]] BodePlot measure_velocity_response(Chip& chip, const LoopDesign& design,
                                                 const Mechanics& mechanics);

}  // namespace stator::experiment::tuning
