#include "stator/control/ramp/s_shaped_profile.hpp"

#include <algorithm>
#include <cmath>

#include "stator/control/ramp/acceleration_pulse.hpp"
#include "stator/control/ramp/root_finding.hpp"

namespace stator::control::s_shaped {

namespace {

constexpr double kGaining = 1.0;
constexpr double kLosing = -1.0;

// Relative; plans made anew in the middle of a bow differ from the old ones by rounding alone.
constexpr double kSameSpeed = 1e-12;
constexpr double kSameLoss = 1e-8;

/// The acceleration on its way towards 0, with the jerk that ends a change of speed.
struct Relaxation {
  Relaxation(double speed, double from, double to, const Slope& slope)
      : time(std::fabs(from - to) * slope.end_bow),
        speed_after(std::max(0.0, speed + 0.5 * (from + to) * time)),
        way(time * (speed + time * ((1.0 / 3.0) * from + (1.0 / 6.0) * to))) {}

  double time;
  double speed_after;
  double way;
};

/// A plan being written, and where its segments have led so far. Speed is a magnitude, and
/// acceleration positive when it is being gained.
class Draft {
 public:
  Draft(MotionPlan& plan, const MotionState& start, double end_jerk, const RampLimits& limits);

  [[nodiscard]] double direction() const { return direction_; }
  [[nodiscard]] const MicrostepPosition& position() const { return position_; }
  /// At rest: reverses the direction in which speed counts.
  void turn() { direction_ = -direction_; }

  void change_to(double speed);
  void stop() { stop_after(braking_way()); }
  /// To rest on `end`, wherever that lies.
  void position_on(const MicrostepPosition& end);

  void rest() { plan_.rest(position_); }
  void cruise() { plan_.cruise(position_, direction_ * speed_); }

 private:
  [[nodiscard]] const Slope& gaining() const { return acceleration_ > 0.0 ? under_way_ : gain_; }
  [[nodiscard]] const Slope& losing() const { return acceleration_ < 0.0 ? under_way_ : lose_; }
  [[nodiscard]] Relaxation relaxation() const { return {speed_, acceleration_, 0.0, under_way_}; }
  [[nodiscard]] AccelerationPulse losing_to(double speed) const {
    return AccelerationPulse::over(losing(), -acceleration_, speed_ - speed);
  }
  [[nodiscard]] double way_to(const MicrostepPosition& target) const {
    return direction_ * distance(position_, target);
  }
  /// Microsteps to rest when braking begins now.
  [[nodiscard]] double braking_way() const;
  void come_to_rest();
  void stop_after(double way) { brake_onto(displaced(position_, direction_ * way)); }
  void brake_onto(const MicrostepPosition& end);
  /// To rest on `end`, which lies beyond the way of braking.
  void approach(const MicrostepPosition& end);
  void relax(double to);
  void apply(const AccelerationPulse& pulse, double sense, double speed_after,
             const MicrostepPosition& end);
  void apply(const AccelerationPulse& pulse, double sense, double speed_after) {
    apply(pulse, sense, speed_after, displaced(position_, direction_ * pulse.way(speed_, sense)));
  }
  void cruise_onto(const MicrostepPosition& end);
  void slow_down_onto(const MicrostepPosition& end);
  void ease_off_onto(const MicrostepPosition& end);
  void gain_onto(const MicrostepPosition& end);
  Slope gain_;
  Slope lose_;
  Slope under_way_;  ///< of the change the start is in, until the acceleration is 0
  StoppingWay stopping_way_;
  double limit_;
  MotionPlan& plan_;
  MicrostepPosition position_;
  double direction_;
  double speed_;
  double acceleration_;
};

/// Bows that were made slower in flight do not hold for an acceleration under way: it could carry
/// the speed past every limit.
double faster(double jerk, double end_jerk) {
  return jerk > 0.0 ? std::max(jerk, end_jerk) : 0.0;
}

Draft::Draft(MotionPlan& plan, const MotionState& start, double end_jerk, const RampLimits& limits)
    : gain_(limits.acceleration, limits.jerk[0], limits.jerk[1]),
      lose_(limits.deceleration, limits.jerk[2], limits.jerk[3]),
      under_way_(gain_),
      stopping_way_(lose_),
      limit_(limits.velocity),
      plan_(plan),
      position_(start.position),
      direction_(start.velocity < 0.0 || (start.velocity == 0.0 && start.acceleration < 0.0) ? -1.0
                                                                                             : 1.0),
      speed_(std::fabs(start.velocity)),
      acceleration_(direction_ * start.acceleration) {
  if (acceleration_ > 0.0) {
    under_way_ = Slope(limits.acceleration, limits.jerk[0], faster(limits.jerk[1], end_jerk));
  } else if (acceleration_ < 0.0) {
    under_way_ = Slope(limits.deceleration, limits.jerk[2], faster(limits.jerk[3], end_jerk));
    const double least_loss = 0.5 * acceleration_ * acceleration_ * under_way_.end_bow;
    if (least_loss > speed_ * (1.0 + kSameLoss)) {
      come_to_rest();
    }
  }
}

/// Losing speed too hard to end it before rest: rest it is, with the jerk that takes.
void Draft::come_to_rest() {
  const double jerk = 0.5 * acceleration_ * acceleration_ / speed_;
  under_way_ = Slope(under_way_.rate, under_way_.start_jerk, jerk);
  relax(0.0);
  speed_ = 0.0;
}

double Draft::braking_way() const {
  if (acceleration_ > 0.0) {
    const Relaxation end = relaxation();
    return end.way + stopping_way_(end.speed_after);
  }
  return losing_to(0.0).way(speed_, kLosing);
}

void Draft::relax(double to) {
  const Relaxation part(speed_, acceleration_, to, under_way_);
  const bool gains = acceleration_ > 0.0;
  plan_.append({.duration = part.time,
                .reference_position = position_,
                .reference_velocity = direction_ * speed_,
                .acceleration = direction_ * acceleration_,
                .jerk = direction_ * (gains ? -under_way_.end_jerk : under_way_.end_jerk),
                .phase = gains ? RampPhase::accelerating : RampPhase::decelerating});
  position_ = displaced(position_, direction_ * part.way);
  speed_ = part.speed_after;
  acceleration_ = to;
}

/// Appends a change of speed, computed backwards from where it ends.
void Draft::apply(const AccelerationPulse& pulse, double sense, double speed_after,
                  const MicrostepPosition& end) {
  const Slope& slope = sense > 0.0 ? gaining() : losing();
  const double signed_sense = direction_ * sense;
  const RampPhase phase = sense > 0.0 ? RampPhase::accelerating : RampPhase::decelerating;
  const double at_hold_end = speed_after - sense * 0.5 * pulse.peak * pulse.end_time;
  const double at_hold_start = at_hold_end - sense * pulse.peak * pulse.hold_time;
  const double end_way =
      pulse.end_time * (speed_after - sense * (1.0 / 6.0) * pulse.peak * pulse.end_time);
  const double hold_way = 0.5 * pulse.hold_time * (at_hold_start + at_hold_end);
  const double start_jerk = pulse.peak < pulse.entry ? -slope.end_jerk : slope.start_jerk;
  plan_.append({.duration = pulse.start_time,
                .reference_time = pulse.start_time,
                .reference_position = displaced(end, -direction_ * (end_way + hold_way)),
                .reference_velocity = direction_ * at_hold_start,
                .acceleration = signed_sense * pulse.peak,
                .jerk = signed_sense * start_jerk,
                .phase = phase});
  plan_.append({.duration = pulse.hold_time,
                .reference_time = pulse.hold_time,
                .reference_position = displaced(end, -direction_ * end_way),
                .reference_velocity = direction_ * at_hold_end,
                .acceleration = signed_sense * pulse.peak,
                .phase = phase});
  plan_.append({.duration = pulse.end_time,
                .reference_time = pulse.end_time,
                .reference_position = end,
                .reference_velocity = direction_ * speed_after,
                .jerk = -signed_sense * slope.end_jerk,
                .phase = phase});
  position_ = end;
  speed_ = speed_after;
  acceleration_ = 0.0;
}

void Draft::change_to(double speed) {
  const auto same = [&] { return std::fabs(speed_ - speed) <= kSameSpeed * speed; };
  if (acceleration_ > 0.0) {
    const double least = relaxation().speed_after;
    if (gain_.rate == 0.0 || least >= speed * (1.0 - kSameSpeed)) {
      relax(0.0);
    }
  } else if (acceleration_ < 0.0 && relaxation().speed_after <= speed) {
    relax(0.0);
  }
  if (same()) {
    speed_ = speed;
  } else if (speed < speed_ && acceleration_ <= 0.0) {
    apply(losing_to(speed), kLosing, speed);
  } else if (gain_.rate > 0.0) {
    apply(AccelerationPulse::over(gaining(), acceleration_, speed - speed_), kGaining, speed);
  }
}

void Draft::brake_onto(const MicrostepPosition& end) {
  if (acceleration_ > 0.0) {
    relax(0.0);
  }
  apply(losing_to(0.0), kLosing, 0.0, end);
}

void Draft::cruise_onto(const MicrostepPosition& end) {
  const double length = way_to(end) - stopping_way_(speed_);
  if (length > 0.0) {
    const double duration = length / speed_;
    plan_.append({.duration = duration,
                  .reference_position = position_,
                  .reference_velocity = direction_ * speed_,
                  .phase = RampPhase::constant_velocity});
    position_ = displaced(position_, direction_ * speed_ * duration);
  }
  brake_onto(end);
}

void Draft::position_on(const MicrostepPosition& end) {
  const double braking = braking_way();
  const double beyond = way_to(end) - braking;
  if (std::fabs(beyond) <= 1e-8 + 1e-12 * braking) {
    brake_onto(end);
    return;
  }
  if (beyond < 0.0) {
    stop_after(braking);
    if (way_to(end) < 0.0) {
      turn();
    }
  }
  approach(end);
}

void Draft::approach(const MicrostepPosition& end) {
  const double highest = limit_ * (1.0 + kSameSpeed);
  const Relaxation end_bow = relaxation();
  if (acceleration_ > 0.0 && (gain_.rate == 0.0 || end_bow.speed_after > highest)) {
    relax(0.0);
  }
  if (acceleration_ <= 0.0 && end_bow.speed_after > highest) {
    slow_down_onto(end);
    return;
  }
  if (acceleration_ < 0.0) {
    const auto short_of = [&] {
      return way_to(end) < end_bow.way + stopping_way_(end_bow.speed_after);
    };
    if (short_of()) {  // braking goes on with the bows it has begun with
      lose_ = under_way_;
      stopping_way_ = StoppingWay(lose_);
    }
    if (short_of()) {
      ease_off_onto(end);
      return;
    }
    relax(0.0);
  }
  if (gain_.rate > 0.0) {
    gain_onto(end);
  } else if (speed_ > 0.0) {
    cruise_onto(end);
  }
}

/// From above the velocity limit: down to it, or if the way is too short for that, below it at
/// once.
void Draft::slow_down_onto(const MicrostepPosition& end) {
  const double length = way_to(end);
  const auto excess = [&](double speed) {
    return losing_to(speed).way(speed_, kLosing) + stopping_way_(speed) - length;
  };
  const FunctionPoint high{limit_, excess(limit_)};
  const double speed = high.y <= 0.0
                           ? limit_
                           : root_between({0.0, excess(0.0)}, high, way_tolerance(length), excess);
  apply(losing_to(speed), kLosing, speed);
  if (high.y <= 0.0) {
    cruise_onto(end);
  } else {
    brake_onto(end);
  }
}

/// While braking for a nearer target: loses less speed for a while, then brakes on.
void Draft::ease_off_onto(const MicrostepPosition& end) {
  const double length = way_to(end);
  const auto excess = [&](double eased) {
    const Relaxation part(speed_, acceleration_, acceleration_ + eased, under_way_);
    const auto rest =
        AccelerationPulse::over(under_way_, -(acceleration_ + eased), part.speed_after);
    return part.way + rest.way(part.speed_after, kLosing) - length;
  };
  // As far as the deceleration is above its rate, it comes down anyway.
  const double least = std::max(0.0, -acceleration_ - under_way_.rate);
  FunctionPoint low{least, excess(least)};
  FunctionPoint high{-acceleration_, excess(-acceleration_)};
  // Mostly what is left is held until rest. The way grows so steeply towards the end of the bracket
  // that the root is hard to find from its begin.
  const double held_to_rest = -acceleration_ - 0.5 * speed_ * speed_ / length;
  if (held_to_rest > low.x && held_to_rest < high.x) {
    const FunctionPoint guess{held_to_rest, excess(held_to_rest)};
    (guess.y < 0.0 ? low : high) = guess;
  }
  const double eased = root_between(low, high, way_tolerance(length), excess);
  relax(acceleration_ + eased);
  brake_onto(end);
}

/// Gains speed and brakes, with a stretch at the velocity limit if the way is long enough.
void Draft::gain_onto(const MicrostepPosition& end) {
  if (acceleration_ > gain_.rate) {
    relax(gain_.rate);
  }
  const double length = way_to(end);
  const double least = relaxation().speed_after;
  const double top = std::max(limit_, least);
  auto pulse = AccelerationPulse::over(gaining(), acceleration_, top - speed_);
  const auto excess = [&](const AccelerationPulse& of) {
    return of.way(speed_, kGaining) + stopping_way_(speed_ + of.change()) - length;
  };
  if (excess(pulse) <= 0.0) {
    apply(pulse, kGaining, top);
    cruise_onto(end);
    return;
  }
  const auto brief = AccelerationPulse::with_peak(gaining(), acceleration_, pulse.peak);
  if (pulse.hold_time > 0.0 && excess(brief) <= 0.0) {
    pulse.hold_time = stopping_way_.hold_before(length, speed_, brief, pulse.hold_time);
  } else {
    pulse = AccelerationPulse::with_peak(
        gaining(), acceleration_,
        stopping_way_.peak_before(length, speed_, gaining(), acceleration_, pulse.peak));
  }
  apply(pulse, kGaining, speed_ + pulse.change());
  brake_onto(end);
}

/// Plans what `drafting` does with a draft and the cleaned limits. Without a deceleration there is
/// no ramp to brake on: the axis rests where it is.
template <typename Drafting>
MotionPlan drafted(const MotionState& start, const RampLimits& limits, double end_jerk,
                   Drafting drafting) {
  const RampLimits allowed = limits.cleaned();
  MotionPlan plan;
  if (allowed.deceleration == 0.0) {
    plan.rest(start.position);
    return plan;
  }
  Draft draft(plan, start, end_jerk, allowed);
  drafting(draft, allowed);
  return plan;
}

}  // namespace

MotionPlan positioning(const MotionState& start, std::int64_t target, const RampLimits& limits,
                       double end_jerk) {
  return drafted(start, limits, end_jerk, [target](Draft& draft, const RampLimits& allowed) {
    if (allowed.velocity == 0.0) {
      draft.stop();
    } else {
      draft.position_on({target, 0.0});
    }
    draft.rest();
  });
}

MotionPlan velocity(const MotionState& start, double velocity, const RampLimits& limits,
                    double end_jerk) {
  return drafted(start, limits, end_jerk, [velocity](Draft& draft, const RampLimits& allowed) {
    const double wanted = std::min(std::fabs(velocity), allowed.velocity);
    if (wanted > 0.0 && velocity * draft.direction() < 0.0) {
      draft.stop();
      draft.turn();
    }
    draft.change_to(wanted);
    draft.cruise();
  });
}

MotionPlan stop(const MotionState& start, const RampLimits& limits, double end_jerk) {
  return drafted(start, limits, end_jerk, [](Draft& draft, const RampLimits& /*allowed*/) {
    draft.stop();
    draft.rest();
  });
}

double braking_distance(const MotionState& start, const RampLimits& limits, double end_jerk) {
  const RampLimits allowed = limits.cleaned();
  if (allowed.deceleration == 0.0) {
    return 0.0;
  }
  MotionPlan plan;
  Draft draft(plan, start, end_jerk, allowed);
  draft.stop();
  return std::fabs(distance(start.position, draft.position()));
}

}  // namespace stator::control::s_shaped
