#pragma once

#include "stator/control/ramp/s_shaped_profile.hpp"
#include "stator/control/ramp/six_point_profile.hpp"

namespace stator::control {

// The profile of the shape the limits name. `end_jerk`: see s_shaped_profile.hpp.

[[nodiscard]] inline MotionPlan plan_positioning(const MotionState& start, std::int64_t target,
                                                 const RampLimits& limits, double end_jerk = 0.0) {
  return limits.shape == RampShape::s_shaped
             ? s_shaped::positioning(start, target, limits, end_jerk)
             : six_point::positioning(start, target, limits);
}

[[nodiscard]] inline MotionPlan plan_velocity(const MotionState& start, double velocity,
                                              const RampLimits& limits, double end_jerk = 0.0) {
  return limits.shape == RampShape::s_shaped ? s_shaped::velocity(start, velocity, limits, end_jerk)
                                             : six_point::velocity(start, velocity, limits);
}

/// To rest: with bows, or with the deceleration alone.
[[nodiscard]] inline MotionPlan plan_stop(const MotionState& start, const RampLimits& limits,
                                          double end_jerk = 0.0) {
  return limits.shape == RampShape::s_shaped ? s_shaped::stop(start, limits, end_jerk)
                                             : six_point::stop(start, limits.deceleration);
}

/// Microsteps from `start` to rest when the profile brakes at once.
[[nodiscard]] inline double braking_distance(const MotionState& start, const RampLimits& limits,
                                             double end_jerk = 0.0) {
  return limits.shape == RampShape::s_shaped ? s_shaped::braking_distance(start, limits, end_jerk)
                                             : six_point::braking_distance(start, limits);
}

}  // namespace stator::control
