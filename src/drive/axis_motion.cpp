#include "drive/axis_motion.hpp"

#include <algorithm>
#include <limits>

#include "control/ramp_profile.hpp"

namespace stator::drive {

namespace {

constexpr std::uint16_t kSShaped = 1;  // of 6086h

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
  return (direction > 0.0 && conditions_.positive_limit_switch) ||
         (direction < 0.0 && conditions_.negative_limit_switch);
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

std::int64_t AxisMotion::move_to(std::int64_t target) {
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
  limited_ = switch_blocks(velocity) || limit_blocks(velocity);
  ramp_.move_at_velocity(limited_ ? 0.0 : velocity, velocity_limits());
  profile_ = Profile::velocity;
}

void AxisMotion::follow_position(std::int64_t target) {
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
  profile_ = Profile::none;
  limited_ = switch_blocks(velocity) || limit_blocks(velocity);
  ramp_.follow_velocity(limited_ ? 0.0
                                 : std::clamp(velocity, -MotionUnits::kMaximumVelocity,
                                              MotionUnits::kMaximumVelocity),
                        objects_.interpolation_period());
}

void AxisMotion::brake(Braking braking) {
  const bool on_profile = profile_ != Profile::none;
  profile_ = Profile::none;
  switch (braking) {
    case Braking::none:
      break;
    case Braking::slow_down_ramp:
      if (const control::RampLimits limits = velocity_limits(); on_profile) {
        ramp_.stop(limits);
      } else {
        ramp_.stop(limits.deceleration);
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
    if (ramp_.mode() != control::RampMode::stop || settings_.ramp.stop_deceleration <= 0.0) {
      ramp_.stop(settings_.ramp.stop_deceleration);
    }
    return;
  }
  stop_before_software_limit(period);
}

void AxisMotion::stop_before_software_limit(base::SimDuration period) {
  const bool on_profile = ramp_.mode() == control::RampMode::velocity;
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
  if (way > 0.0 && limits.deceleration > 0.0) {
    limits.velocity = on_profile ? direction * ramp_.target_velocity() : speed;
    ramp_.move_to(*limit, limits);
  } else {
    ramp_.stop(limits);
  }
}

}  // namespace stator::drive
