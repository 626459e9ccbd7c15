#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/control/ramp/motion_plan.hpp"

namespace stator::control {

// Set-points of the cyclic synchronous modes between two targets of the master (CiA 402, 60C2h). No
// ramp of the drive is used; jumps of velocity or acceleration are the master's responsibility.

/// csp: constant velocity so that `target` is reached after `period`, then hold the position. A
/// period of zero or less jumps to the target.
[[nodiscard]] MotionPlan plan_position_interpolation(const MotionState& start, std::int64_t target,
                                                     base::SimDuration period);

/// csv: constant acceleration so that `velocity` (pps) is reached after `period`, then hold the
/// velocity. A period of zero or less jumps to the velocity.
[[nodiscard]] MotionPlan plan_velocity_interpolation(const MotionState& start, double velocity,
                                                     base::SimDuration period);

}  // namespace stator::control
