#include "drive/axis_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/ramp_profile.hpp"

namespace stator::drive {

namespace {

constexpr std::uint16_t kSShaped = 1;  // of 6086h

// A rotor that does not turn is followed to this many microsteps: less than a count of an encoder.
constexpr double kStandstill = 0.5;

constexpr std::int32_t kNoMinimum = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kNoMaximum = std::numeric_limits<std::int32_t>::max();

}  // namespace

std::int64_t AxisMotion::turn() const {
  return position() - static_cast<std::int32_t>(position());
}

std::int64_t AxisMotion::absolute(std::int32_t object) const {
  return turn() + object;
}

std::int64_t AxisMotion::cyclic(std::int64_t sum) const {
  if (lower_limit() || upper_limit()) {
    return turn() + sum;
  }
  return position() + static_cast<std::int32_t>(sum - position());
}

std::optional<std::int64_t> AxisMotion::lower_limit() const {
  const std::int32_t minimum = objects_.minimum_position.get();
  if (minimum == kNoMinimum) {
    return std::nullopt;
  }
  return turn() + minimum - objects_.home_offset.get();
}

std::optional<std::int64_t> AxisMotion::upper_limit() const {
  const std::int32_t maximum = objects_.maximum_position.get();
  if (maximum == kNoMaximum) {
    return std::nullopt;
  }
  return turn() + maximum - objects_.home_offset.get();
}

std::int64_t AxisMotion::clamped(std::int64_t target) {
  std::int64_t result = target;
  if (const auto upper = upper_limit()) {
    result = std::min(result, *upper);
  }
  if (const auto lower = lower_limit()) {
    result = std::max(result, *lower);
  }
  limited_ = result != target;
  return result;
}

bool AxisMotion::switch_blocks(double direction) const {
  const PassedSwitches passed = profile_ == Profile::search ? passed_ : PassedSwitches{};
  return (direction > 0.0 && conditions_.positive_limit_switch && !passed.positive_limit) ||
         (direction < 0.0 && conditions_.negative_limit_switch && !passed.negative_limit);
}

bool AxisMotion::limit_blocks(double direction) const {
  const auto upper = upper_limit();
  const auto lower = lower_limit();
  return (direction > 0.0 && upper && position() >= *upper) ||
         (direction < 0.0 && lower && position() <= *lower);
}

control::RampLimits AxisMotion::profile_limits() const {
  control::RampLimits limits = velocity_limits();
  limits.velocity = settings_.units.velocity(objects_.profile_velocity.get());
  limits.end_velocity = settings_.units.velocity(objects_.end_velocity.get());
  limits.stop_deceleration = settings_.ramp.stop_deceleration;
  return limits;
}

control::RampLimits AxisMotion::velocity_limits() const {
  const MotionUnits& units = settings_.units;
  const RampSettings& ramp = settings_.ramp;
  control::RampLimits limits{
      .velocity = MotionUnits::kMaximumVelocity,
      .acceleration = units.acceleration(objects_.profile_acceleration.get()),
      .deceleration = units.acceleration(objects_.profile_deceleration.get()),
      .shape = objects_.profile_type.get() == kSShaped ? control::RampShape::s_shaped
                                                       : control::RampShape::six_point,
      .start_velocity = ramp.start_velocity,
      .start_acceleration = ramp.start_acceleration,
      .break_velocity = ramp.break_velocity,
      .final_deceleration = ramp.final_deceleration};
  for (std::size_t i = 0; i < limits.jerk.size(); ++i) {
    limits.jerk[i] = MotionUnits::jerk(objects_.jerk[i].get(), ramp.bow_factor);
  }
  return limits;
}

control::RampLimits AxisMotion::search_limits(double velocity) const {
  const double acceleration = settings_.units.acceleration(objects_.homing_acceleration.get());
  return {.velocity = std::min(velocity, MotionUnits::kMaximumVelocity),
          .acceleration = acceleration,
          .deceleration = acceleration};
}

std::int64_t AxisMotion::move_to(std::int64_t target) {
  end_torque();
  const std::int64_t allowed = clamped(target);
  const auto way = static_cast<double>(allowed - position());
  if (switch_blocks(way)) {
    limited_ = true;
    brake(Braking::slow_down_ramp);
  } else {
    ramp_.move_to(allowed, profile_limits());
    profile_ = Profile::positioning;
  }
  return allowed;
}

void AxisMotion::move_at_velocity(double velocity) {
  end_torque();
  limited_ = switch_blocks(velocity) || limit_blocks(velocity);
  ramp_.move_at_velocity(limited_ ? 0.0 : velocity, velocity_limits());
  profile_ = Profile::velocity;
}

void AxisMotion::follow_position(std::int64_t target) {
  end_torque();
  profile_ = Profile::none;
  const std::int64_t allowed = clamped(target);
  if (switch_blocks(static_cast<double>(allowed - position()))) {
    limited_ = true;
    ramp_.stop_at_once();
  } else {
    ramp_.follow_position(allowed, objects_.interpolation_period());
  }
}

void AxisMotion::follow_velocity(double velocity) {
  end_torque();
  profile_ = Profile::none;
  limited_ = switch_blocks(velocity) || limit_blocks(velocity);
  ramp_.follow_velocity(limited_ ? 0.0
                                 : std::clamp(velocity, -MotionUnits::kMaximumVelocity,
                                              MotionUnits::kMaximumVelocity),
                        objects_.interpolation_period());
}

bool AxisMotion::search_blocked(double direction, const PassedSwitches& passed) {
  end_torque();
  profile_ = Profile::search;
  passed_ = passed;
  limited_ = switch_blocks(direction);
  if (limited_ && ramp_.mode() != control::RampMode::stop) {
    ramp_.stop(settings_.ramp.stop_deceleration);
  }
  return limited_;
}

void AxisMotion::search_at_velocity(double velocity, const PassedSwitches& passed) {
  if (!search_blocked(velocity, passed)) {
    ramp_.move_at_velocity(velocity, search_limits(MotionUnits::kMaximumVelocity));
  }
}

void AxisMotion::search_to(std::int64_t target, double velocity, const PassedSwitches& passed) {
  if (!search_blocked(static_cast<double>(target - position()), passed)) {
    ramp_.move_to(target, search_limits(velocity));
  }
}

void AxisMotion::hold_against(double direction) {
  limited_ = true;
  torque_.reset();
  held_direction_ = direction;
}

void AxisMotion::apply_torque(double amperes) {
  if (held_direction_ != 0.0) {
    if (!at_rest() || amperes * held_direction_ > 0.0) {
      return;
    }
    held_direction_ = 0.0;
  }
  if (switch_blocks(amperes) || limit_blocks(amperes)) {
    brake(Braking::slow_down_ramp);
    hold_against(amperes);
    return;
  }
  limited_ = false;
  profile_ = Profile::none;
  torque_ = amperes;
}

void AxisMotion::follow_rotor(double deviation, double velocity) {
  // Fast enough to be a microstep or two away at the accelerations of a motor, slow enough not to
  // take the counts of an encoder for a velocity.
  constexpr double kTimeConstant = 4e-3;  // s
  const bool stands = velocity == 0.0 && std::abs(deviation) < kStandstill;
  ramp_.follow_velocity(stands ? 0.0 : velocity - deviation / kTimeConstant, base::SimDuration(0));
}

void AxisMotion::brake(Braking braking) {
  const bool searches = profile_ == Profile::search;
  const bool on_profile = profile_ != Profile::none && !searches;
  profile_ = Profile::none;
  end_torque();
  switch (braking) {
    case Braking::none:
      break;
    case Braking::slow_down_ramp:
      if (searches) {
        ramp_.stop(search_limits(MotionUnits::kMaximumVelocity).deceleration);
      } else if (on_profile) {
        ramp_.stop(velocity_limits());
      } else {
        ramp_.stop(velocity_limits().deceleration);
      }
      break;
    case Braking::quick_stop_ramp:
      ramp_.stop(settings_.units.acceleration(objects_.quick_stop_deceleration.get()));
      break;
    case Braking::at_once:
      ramp_.stop_at_once();
      break;
  }
}

void AxisMotion::supervise(base::SimDuration period) {
  if (profile_ == Profile::positioning) {
    ramp_.set_limits(profile_limits());
  } else if (profile_ == Profile::velocity) {
    ramp_.set_limits(velocity_limits());
  }
  if (switch_blocks(velocity())) {
    limited_ = true;
    profile_ = Profile::none;
    if (torque_) {
      hold_against(velocity());
    }
    if (ramp_.mode() != control::RampMode::stop || settings_.ramp.stop_deceleration <= 0.0) {
      ramp_.stop(settings_.ramp.stop_deceleration);
    }
    return;
  }
  stop_before_software_limit(period);
}

void AxisMotion::stop_before_software_limit(base::SimDuration period) {
  const bool on_profile =
      ramp_.mode() == control::RampMode::velocity && profile_ != Profile::search;
  const double direction = velocity() < 0.0 ? -1.0 : 1.0;
  const auto limit = velocity() > 0.0 ? upper_limit() : lower_limit();
  if (!(on_profile || ramp_.mode() == control::RampMode::follow_velocity) || velocity() == 0.0 ||
      !limit || (on_profile && ramp_.target_velocity() * direction <= 0.0)) {
    return;  // the last: it brakes as hard as it may already
  }
  control::RampLimits limits = velocity_limits();
  if (!on_profile) {
    limits = {.acceleration = limits.deceleration, .deceleration = limits.deceleration};
  }
  // Two periods ahead: this one and the one after, in which it would be too late.
  const double ahead = 2.0 * period.seconds();
  control::MotionState later = ramp_.state().now;
  const double gained = std::max(0.0, direction * later.acceleration);
  double acceleration = gained;
  if (on_profile && ramp_.phase() == control::RampPhase::accelerating && limits.jerk[0] > 0.0) {
    acceleration = std::min(std::max(gained, limits.acceleration), gained + limits.jerk[0] * ahead);
  }
  later.acceleration = direction * acceleration;
  later.velocity += later.acceleration * ahead;
  const double speed = direction * later.velocity;
  const auto way = direction * static_cast<double>(*limit - position());
  // A microstep more for the fraction that the integer position leaves out.
  if (way > control::braking_distance(later, limits) + speed * ahead + 1.0) {
    return;
  }
  limited_ = true;
  profile_ = Profile::none;
  if (torque_) {
    hold_against(velocity());
  }
  if (way > 0.0 && limits.deceleration > 0.0) {
    limits.velocity = on_profile ? direction * ramp_.target_velocity() : speed;
    ramp_.move_to(*limit, limits);
  } else {
    ramp_.stop(limits);
  }
}

}  // namespace stator::drive
