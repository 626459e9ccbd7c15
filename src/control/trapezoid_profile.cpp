#include "control/trapezoid_profile.hpp"

#include <algorithm>
#include <cmath>

namespace stator::control {

namespace {

double clean(double value, double maximum) {
  return value > 0.0 ? std::min(value, maximum) : 0.0;  // also turns "not a number" into 0
}

RampLimits clean(const RampLimits& limits) {
  return {.velocity = clean(limits.velocity, 1e9),
          .acceleration = clean(limits.acceleration, 1e12),
          .deceleration = clean(limits.deceleration, 1e12)};
}

/// A plan being written, and the position and velocity its segments have reached so far.
struct Draft {
  MotionPlan plan;
  MicrostepPosition position;
  double velocity;

  /// Changes the speed to `velocity_after`, which has the present direction (or either is 0), with
  /// the magnitude `rate` > 0.
  void ramp_to(double velocity_after, double rate) {
    const bool gaining = std::fabs(velocity_after) > std::fabs(velocity);
    const double change = velocity_after - velocity;
    const double duration = std::fabs(change) / rate;
    plan.append({.duration = duration,
                 .reference_position = position,
                 .reference_velocity = velocity,
                 .acceleration = change > 0.0 ? rate : -rate,
                 .phase = gaining ? RampPhase::accelerating : RampPhase::decelerating});
    position = displaced(position, 0.5 * (velocity + velocity_after) * duration);
    velocity = velocity_after;
  }

  /// Keeps the velocity over `length` microsteps (magnitude).
  void cruise_over(double length) {
    if (length <= 0.0) {
      return;
    }
    const double duration = length / std::fabs(velocity);
    plan.append({.duration = duration,
                 .reference_position = position,
                 .reference_velocity = velocity,
                 .phase = RampPhase::constant_velocity});
    position = displaced(position, velocity * duration);
  }

  /// Brakes to rest with `rate`, computed backwards from where it ends.
  void brake_onto(const MicrostepPosition& end, double rate) {
    const double duration = std::fabs(velocity) / rate;
    plan.append({.duration = duration,
                 .reference_time = duration,
                 .reference_position = end,
                 .acceleration = velocity > 0.0 ? -rate : rate,
                 .phase = RampPhase::decelerating});
    plan.rest(end);
  }
};

/// Signed distance covered while braking from `velocity` to rest.
double braking_distance(double velocity, double deceleration) {
  return 0.5 * velocity * std::fabs(velocity) / deceleration;
}

MotionPlan standing(const MicrostepPosition& position) {
  MotionPlan plan;
  plan.rest(position);
  return plan;
}

/// From a speed towards the target that can still be braked in front of it.
MotionPlan approach(Draft draft, const MicrostepPosition& target, const RampLimits& limits) {
  const double remaining = distance(draft.position, target);
  const double length = std::fabs(remaining);
  const double direction = remaining < 0.0 ? -1.0 : 1.0;
  const double a = limits.acceleration;
  const double d = limits.deceleration;
  const double speed = std::fabs(draft.velocity);

  double peak = speed;
  if (speed > limits.velocity) {
    peak = limits.velocity;
    draft.ramp_to(direction * peak, d);
  } else if (a > 0.0) {
    peak = std::sqrt((2.0 * a * d * length + d * speed * speed) / (a + d));
    peak = std::clamp(peak, speed, limits.velocity);
    draft.ramp_to(direction * peak, a);
  }
  if (peak == 0.0) {
    draft.plan.rest(draft.position);
    return draft.plan;
  }
  // In a triangle what is left to cruise is rounding.
  const double cruise = direction * distance(draft.position, target) - 0.5 * peak * peak / d;
  if (peak == limits.velocity || a == 0.0) {
    draft.cruise_over(cruise);
  }
  draft.brake_onto(target, d);
  return draft.plan;
}

}  // namespace

MotionPlan plan_positioning(const MotionState& start, std::int64_t target,
                            const RampLimits& limits) {
  const RampLimits usable = clean(limits);
  const MicrostepPosition end{target, 0.0};
  if (usable.deceleration == 0.0) {
    return standing(start.position);
  }
  if (usable.velocity == 0.0) {
    return plan_stop(start, usable.deceleration);
  }
  Draft draft{{}, start.position, start.velocity};
  const double braking = braking_distance(start.velocity, usable.deceleration);
  const double beyond = distance(start.position, end) - braking;
  // A plan made anew while braking for the same target differs from it by rounding alone; that must
  // not become an excursion past the target and back.
  const double rounding = 1e-9 + 1e-13 * std::fabs(braking);
  if (std::fabs(beyond) <= rounding) {
    draft.brake_onto(end, usable.deceleration);
    return draft.plan;
  }
  const bool overshoots = start.velocity != 0.0 && (start.velocity > 0.0) != (beyond > 0.0);
  if (overshoots) {
    draft.ramp_to(0.0, usable.deceleration);
  }
  return approach(draft, end, usable);
}

MotionPlan plan_velocity(const MotionState& start, double velocity, const RampLimits& limits) {
  const RampLimits usable = clean(limits);
  if (usable.deceleration == 0.0) {
    return standing(start.position);
  }
  const double wanted = std::clamp(velocity, -usable.velocity, usable.velocity);
  Draft draft{{}, start.position, start.velocity};
  const bool reverses =
      (start.velocity > 0.0 && wanted < 0.0) || (start.velocity < 0.0 && wanted > 0.0);
  if (reverses) {
    draft.ramp_to(0.0, usable.deceleration);
  }
  if (std::fabs(wanted) < std::fabs(draft.velocity)) {
    draft.ramp_to(wanted, usable.deceleration);
  } else if (usable.acceleration > 0.0) {
    draft.ramp_to(wanted, usable.acceleration);
  }
  draft.plan.cruise(draft.position, draft.velocity);
  return draft.plan;
}

MotionPlan plan_stop(const MotionState& start, double deceleration) {
  const double rate = clean(deceleration, 1e12);
  if (rate == 0.0 || start.velocity == 0.0) {
    return standing(start.position);
  }
  Draft draft{{}, start.position, start.velocity};
  draft.brake_onto(displaced(start.position, braking_distance(start.velocity, rate)), rate);
  return draft.plan;
}

}  // namespace stator::control
