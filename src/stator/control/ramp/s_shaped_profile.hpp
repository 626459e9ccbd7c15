#pragma once

#include "stator/control/ramp/motion_plan.hpp"
#include "stator/control/ramp/ramp_limits.hpp"

namespace stator::control::s_shaped {

// Ramps with four bows from any moving start, velocity and acceleration: the acceleration changes
// with jerk 1 at the start of gaining speed, 2 at its end, 3 at the start of losing speed, 4 at its
// end. As in the TMC4361 the acceleration comes back to 0 between gaining and losing speed, and
// speed is lost towards 0 and gained from 0, never through it. An acceleration under way when its
// limit or the velocity limit is lowered comes down with the jerk of its end, which may carry the
// speed past the lowered limit, not past the former one.
//
// `end_jerk` (pps/s^2): with what the acceleration of the start was going to end; a smaller jerk in
// the limits does not apply to it.
//
// Start, break and end velocity belong to six-point ramps and have no meaning here.

/// Profile to rest on the whole microstep `target`. A start too fast for the distance, or moving
/// away, stops first and returns; a start above the velocity limit comes down with the
/// deceleration.
[[nodiscard]] MotionPlan positioning(const MotionState& start, std::int64_t target,
                                     const RampLimits& limits, double end_jerk = 0.0);

/// Profile to the signed `velocity` (pps), kept for ever; limits.velocity caps its magnitude.
[[nodiscard]] MotionPlan velocity(const MotionState& start, double velocity,
                                  const RampLimits& limits, double end_jerk = 0.0);

/// Profile to rest; deceleration 0 stops at once.
[[nodiscard]] MotionPlan stop(const MotionState& start, const RampLimits& limits,
                              double end_jerk = 0.0);

/// Microsteps (magnitude) from `start` to rest when braking at once.
[[nodiscard]] double braking_distance(const MotionState& start, const RampLimits& limits,
                                      double end_jerk = 0.0);

}  // namespace stator::control::s_shaped
