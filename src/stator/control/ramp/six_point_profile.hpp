#pragma once

#include "stator/control/ramp/motion_plan.hpp"
#include "stator/control/ramp/ramp_limits.hpp"

namespace stator::control::six_point {

// Ramps of constant accelerations from any moving start, time-optimal within these rules:
//   gaining speed: from rest a step to start_velocity, then start_acceleration up to
//                  break_velocity, then acceleration;
//   losing speed:  deceleration down to break_velocity, then final_deceleration;
//   positioning:   losing speed ends at end_velocity, and the rest of the way to the target is
//                  made with stop_deceleration, or with a step to 0 on the target.
// A trapezoid is the ramp without break, start and end velocity.

/// Profile to rest on the whole microstep `target`. A start too fast for the distance, or moving
/// away, loses all its speed first and returns; a start above the velocity limit comes down with
/// the deceleration.
[[nodiscard]] MotionPlan positioning(const MotionState& start, std::int64_t target,
                                     const RampLimits& limits);

/// Profile to the signed `velocity` (pps), kept for ever; limits.velocity caps its magnitude. The
/// end velocity has no meaning here.
[[nodiscard]] MotionPlan velocity(const MotionState& start, double velocity,
                                  const RampLimits& limits);

/// Profile to rest with `deceleration` (pps/s) alone; 0 stops at once.
[[nodiscard]] MotionPlan stop(const MotionState& start, double deceleration);

/// Microsteps (magnitude) from `start` to rest when positioning brakes at once.
[[nodiscard]] double braking_distance(const MotionState& start, const RampLimits& limits);

}  // namespace stator::control::six_point
