#include "stator/control/ramp/interpolation_profile.hpp"

#include <cmath>

namespace stator::control {

MotionPlan plan_position_interpolation(const MotionState& start, std::int64_t target,
                                       base::SimDuration period) {
  const MicrostepPosition end{target, 0.0};
  const double length = distance(start.position, end);
  MotionPlan plan;
  if (length != 0.0 && period > base::SimDuration(0)) {
    plan.append({.duration = period.seconds(),
                 .reference_time = period.seconds(),
                 .reference_position = end,
                 .reference_velocity = length / period.seconds(),
                 .phase = RampPhase::constant_velocity});
  }
  plan.rest(end);
  return plan;
}

MotionPlan plan_velocity_interpolation(const MotionState& start, double velocity,
                                       base::SimDuration period) {
  MotionPlan plan;
  MicrostepPosition position = start.position;
  const double change = velocity - start.velocity;
  if (change != 0.0 && period > base::SimDuration(0)) {
    const double duration = period.seconds();
    const bool gaining = std::fabs(velocity) > std::fabs(start.velocity);
    plan.append({.duration = duration,
                 .reference_position = position,
                 .reference_velocity = start.velocity,
                 .acceleration = change / duration,
                 .phase = gaining ? RampPhase::accelerating : RampPhase::decelerating});
    position = displaced(position, 0.5 * (start.velocity + velocity) * duration);
  }
  plan.cruise(position, velocity);
  return plan;
}

}  // namespace stator::control
