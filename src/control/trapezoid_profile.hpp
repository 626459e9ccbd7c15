#pragma once

#include "control/motion_plan.hpp"

namespace stator::control {

/// What a trapezoidal ramp may use. Values that are negative or not a number count as 0.
struct RampLimits {
  double velocity = 0.0;      ///< pps, up to 1e9
  double acceleration = 0.0;  ///< pps/s, gaining speed, up to 1e12
  double deceleration = 0.0;  ///< pps/s, losing speed, up to 1e12

  friend constexpr bool operator==(const RampLimits&, const RampLimits&) = default;
};

// Trapezoidal profiles from any moving start (asymmetric: acceleration and deceleration differ).
// Limits of 0, because a drive that has not been parameterised must not move:
//   deceleration 0: there is no ramp to brake on, so an axis in motion stops at once and one at
//   rest
//                   does not start;
//   acceleration 0: the axis never gains speed, hence does not start from rest;
//   velocity 0:     the axis brakes to rest and stays.

/// Time-optimal profile to rest on the whole microstep `target`. With distance X and speed v0
/// towards it the peak is vp^2 = (2 a d X + d v0^2) / (a + d), at most the velocity limit. A start
/// too fast for the distance, or moving away, stops first and returns; a start above the velocity
/// limit comes down with the deceleration.
[[nodiscard]] MotionPlan plan_positioning(const MotionState& start, std::int64_t target,
                                          const RampLimits& limits);

/// Profile to the signed `velocity` (pps), kept for ever; limits.velocity caps its magnitude.
[[nodiscard]] MotionPlan plan_velocity(const MotionState& start, double velocity,
                                       const RampLimits& limits);

/// Profile to rest with `deceleration` (pps/s); 0 stops at once.
[[nodiscard]] MotionPlan plan_stop(const MotionState& start, double deceleration);

}  // namespace stator::control
