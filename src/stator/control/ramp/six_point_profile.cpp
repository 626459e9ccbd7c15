#include "stator/control/ramp/six_point_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stator::control::six_point {

namespace {

double square(double x) {
  return x * x;
}

/// Microsteps to change between two speeds, `higher` >= `lower`, at a constant `rate`.
double way_between(double higher, double lower, double rate) {
  return higher > lower ? 0.5 * (square(higher) - square(lower)) / rate : 0.0;
}

/// There is something to brake with at every speed.
bool can_brake(const RampLimits& limits) {
  return limits.deceleration > 0.0 &&
         (limits.break_velocity == 0.0 || limits.final_deceleration > 0.0);
}

/// Speeds at which braking from `speed` to rest changes its rate, and the ways between them.
struct Braking {
  Braking(double speed, const RampLimits& limits)
      : end(std::min(speed, limits.end_velocity)),
        corner(std::clamp(limits.break_velocity, end, speed)),
        way{way_between(speed, corner, limits.deceleration),
            way_between(corner, end, limits.final_deceleration),
            limits.stop_deceleration > 0.0 ? way_between(end, 0.0, limits.stop_deceleration)
                                           : 0.0} {}
  [[nodiscard]] double total() const { return way[0] + way[1] + way[2]; }

  double end;
  double corner;
  std::array<double, 3> way;
};

/// A plan being written, and where its segments have led so far. Speeds are magnitudes.
class Draft {
 public:
  Draft(const MotionState& start, const RampLimits& limits)
      : limits_(limits),
        position_(start.position),
        direction_(start.velocity < 0.0 ? -1.0 : 1.0),
        speed_(std::fabs(start.velocity)) {}

  [[nodiscard]] double speed() const { return speed_; }
  [[nodiscard]] double way_to(const MicrostepPosition& target) const {
    return direction_ * distance(position_, target);
  }
  /// At rest: reverses the direction in which speed counts.
  void turn() { direction_ = -direction_; }

  /// Steps to a speed, at a start from rest.
  void step_to(double speed) { speed_ = speed; }
  void gain_to(double after) {
    ramp(std::clamp(limits_.break_velocity, speed_, after), limits_.start_acceleration);
    ramp(after, limits_.acceleration);
  }
  void lose_to(double after) {
    ramp(std::clamp(limits_.break_velocity, after, speed_), limits_.deceleration);
    ramp(after, limits_.final_deceleration);
  }
  void cruise_over(double length) {
    if (length > 0.0) {
      const double duration = length / speed_;
      plan_.append({.duration = duration,
                    .reference_position = position_,
                    .reference_velocity = direction_ * speed_,
                    .phase = RampPhase::constant_velocity});
      position_ = displaced(position_, direction_ * speed_ * duration);
    }
  }
  /// Brakes to rest, computed backwards from where it ends.
  void brake_onto(const MicrostepPosition& end) {
    const Braking braking(speed_, limits_);
    const auto before = [&](double way) { return displaced(end, -direction_ * way); };
    brake(speed_, braking.corner, limits_.deceleration, before(braking.way[1] + braking.way[2]));
    brake(braking.corner, braking.end, limits_.final_deceleration, before(braking.way[2]));
    if (limits_.stop_deceleration > 0.0) {
      brake(braking.end, 0.0, limits_.stop_deceleration, end);
    }
    position_ = end;
    speed_ = 0.0;
  }
  /// Brakes to rest now, wherever that is.
  void stop() { brake_onto(displaced(position_, direction_ * Braking(speed_, limits_).total())); }

  MotionPlan rest() {
    plan_.rest(position_);
    return plan_;
  }
  MotionPlan cruise() {
    plan_.cruise(position_, direction_ * speed_);
    return plan_;
  }

 private:
  void ramp(double after, double rate) {
    const double change = after - speed_;
    const bool gaining = change > 0.0;
    if (change == 0.0 || (gaining && rate == 0.0)) {
      return;
    }
    const double duration = std::fabs(change) / rate;
    plan_.append({.duration = duration,
                  .reference_position = position_,
                  .reference_velocity = direction_ * speed_,
                  .acceleration = gaining ? direction_ * rate : -direction_ * rate,
                  .phase = gaining ? RampPhase::accelerating : RampPhase::decelerating});
    position_ = displaced(position_, direction_ * 0.5 * (speed_ + after) * duration);
    speed_ = after;
  }
  void brake(double from, double to, double rate, const MicrostepPosition& end) {
    if (from <= to) {
      return;
    }
    const double duration = (from - to) / rate;
    plan_.append({.duration = duration,
                  .reference_time = duration,
                  .reference_position = end,
                  .reference_velocity = direction_ * to,
                  .acceleration = -direction_ * rate,
                  .phase = RampPhase::decelerating});
  }

  const RampLimits& limits_;
  MotionPlan plan_;
  MicrostepPosition position_;
  double direction_;
  double speed_;
};

/// Highest speed an axis that has `speed` can get to.
double ceiling(double speed, const RampLimits& limits) {
  const bool gains = limits.acceleration > 0.0 &&
                     (speed >= limits.break_velocity || limits.start_acceleration > 0.0);
  return gains ? limits.velocity : speed;
}

/// Highest speed, at most `top`, on a way of `length` that begins with `speed` and ends at rest.
/// Ways of gaining and losing speed are piecewise linear in the squared speed, hence so is their
/// sum: the peak is found between two of its corners.
double peak_speed(double speed, double top, double length, const RampLimits& limits) {
  const auto gained = [&](double higher) {
    const double corner = std::clamp(limits.break_velocity, speed, higher);
    return way_between(corner, speed, limits.start_acceleration) +
           way_between(higher, corner, limits.acceleration);
  };
  std::array corners{speed, limits.break_velocity, limits.end_velocity};
  std::sort(corners.begin(), corners.end());
  double lower = 0.0;
  double way_at_lower = 0.0;
  for (const double corner : {corners[0], corners[1], corners[2], top}) {
    const double upper = std::min(corner, top);
    const double way = (upper > speed ? gained(upper) : 0.0) + Braking(upper, limits).total();
    if (way >= length && way > way_at_lower) {
      const double part = (length - way_at_lower) / (way - way_at_lower);
      return std::sqrt(square(lower) + part * (square(upper) - square(lower)));
    }
    lower = upper;
    way_at_lower = way;
  }
  return top;
}

/// From a speed towards the target that can still be braked in front of it.
MotionPlan approach(Draft& draft, const MicrostepPosition& target, const RampLimits& limits) {
  const double length = draft.way_to(target);
  if (draft.speed() > limits.velocity) {
    draft.lose_to(limits.velocity);
  } else {
    const bool starts = draft.speed() == 0.0;
    if (starts && limits.acceleration > 0.0) {
      draft.step_to(std::min(limits.start_velocity, limits.velocity));
    }
    const double top = ceiling(draft.speed(), limits);
    const double peak = peak_speed(draft.speed(), top, length, limits);
    if (starts && peak < draft.speed()) {
      draft.step_to(peak);
    } else if (peak > draft.speed()) {
      draft.gain_to(peak);
    }
    if (draft.speed() == 0.0) {
      return draft.rest();
    }
    if (peak < top) {  // what is left to cruise is rounding
      draft.brake_onto(target);
      return draft.rest();
    }
  }
  draft.cruise_over(draft.way_to(target) - Braking(draft.speed(), limits).total());
  draft.brake_onto(target);
  return draft.rest();
}

/// `limits` with an end velocity that is at most the limit, since a higher one would mean to brake
/// only from below the limit.
RampLimits usable(const RampLimits& limits) {
  RampLimits result = limits.cleaned();
  result.end_velocity = std::min(result.end_velocity, result.velocity);
  return result;
}

}  // namespace

MotionPlan positioning(const MotionState& start, std::int64_t target, const RampLimits& limits) {
  const RampLimits allowed = usable(limits);
  const MicrostepPosition end{target, 0.0};
  Draft draft(start, allowed);
  if (!can_brake(allowed)) {
    return draft.rest();
  }
  if (allowed.velocity == 0.0) {
    draft.stop();
    return draft.rest();
  }
  const double braking = Braking(draft.speed(), allowed).total();
  const double beyond = draft.way_to(end) - braking;
  // A plan made anew while braking for the same target differs from it by rounding alone; that must
  // not become an excursion past the target and back.
  if (std::fabs(beyond) <= 1e-9 + 1e-13 * braking) {
    draft.brake_onto(end);
    return draft.rest();
  }
  if (beyond < 0.0) {
    draft.lose_to(0.0);  // the end velocity is that of the target
    if (draft.way_to(end) < 0.0) {
      draft.turn();
    }
  }
  return approach(draft, end, allowed);
}

MotionPlan velocity(const MotionState& start, double velocity, const RampLimits& limits) {
  const RampLimits allowed = usable(limits);
  Draft draft(start, allowed);
  if (!can_brake(allowed)) {
    return draft.rest();
  }
  const double wanted = std::min(std::fabs(velocity), allowed.velocity);
  const bool opposed = velocity < 0.0 ? !(start.velocity < 0.0) : start.velocity < 0.0;
  if (opposed && wanted > 0.0) {
    draft.lose_to(0.0);
    draft.turn();
  }
  if (draft.speed() == 0.0 && allowed.acceleration > 0.0) {
    draft.step_to(std::min(allowed.start_velocity, wanted));
  }
  if (wanted < draft.speed()) {
    draft.lose_to(wanted);
  } else if (ceiling(draft.speed(), allowed) > draft.speed()) {
    draft.gain_to(wanted);
  }
  return draft.cruise();
}

MotionPlan stop(const MotionState& start, double deceleration) {
  const RampLimits allowed = RampLimits{.deceleration = deceleration}.cleaned();
  Draft draft(start, allowed);
  if (can_brake(allowed)) {
    draft.stop();
  }
  return draft.rest();
}

double braking_distance(const MotionState& start, const RampLimits& limits) {
  const RampLimits allowed = usable(limits);
  return can_brake(allowed) ? Braking(std::fabs(start.velocity), allowed).total() : 0.0;
}

}  // namespace stator::control::six_point
