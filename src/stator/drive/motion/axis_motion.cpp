#include "stator/drive/motion/axis_motion.hpp"

#include <algorithm>
#include <cmath>

#include "stator/control/ramp/ramp_profile.hpp"

namespace stator::drive {

namespace {

constexpr std::uint16_t kSShaped = 1;  // of 6086h

}  // namespace

std::int64_t AxisMotion::turn() const {
  return scale_ == 1.0 ? position() - static_cast<std::int32_t>(position()) : 0;
}

std::int64_t AxisMotion::scaled(std::int64_t increments) const {
  return scale_ == 1.0 ? increments : std::llround(static_cast<double>(increments) * scale_);
}

std::int64_t AxisMotion::unscaled(std::int64_t object) const {
  return scale_ == 1.0 ? object : std::llround(static_cast<double>(object) / scale_);
}

std::int64_t AxisMotion::absolute(std::int32_t object) const {
  return turn() + unscaled(object);
}

std::int64_t AxisMotion::cyclic(std::int32_t target, std::int32_t offset) const {
  const auto nearest = [this](std::int64_t lower_bits) {
    return position() + static_cast<std::int32_t>(lower_bits - position());
  };
  return has_limits() ? nearest(target) + offset : nearest(std::int64_t{target} + offset);
}

control::RampLimits AxisMotion::profile_limits() const {
  control::RampLimits limits = velocity_limits();
  limits.velocity = profile_velocity();
  limits.end_velocity = settings_.behaviour.end_velocity_goes_on ? 0.0 : end_velocity();
  limits.stop_deceleration = settings_.ramp.stop_deceleration;
  return limits;
}

double AxisMotion::profile_velocity() const {
  const std::uint32_t object = objects_.profile_velocity.get();
  return object == 0 && settings_.behaviour.zero_velocity_is_largest
             ? settings_.units.maximum_velocity()
             : settings_.units.velocity(object);
}

double AxisMotion::end_velocity() const {
  return settings_.units.velocity(std::abs(static_cast<double>(objects_.end_velocity.get())));
}

control::RampLimits AxisMotion::velocity_limits() const {
  const MotionUnits& units = settings_.units;
  const RampSettings& ramp = settings_.ramp;
  control::RampLimits limits{
      .velocity = units.maximum_velocity(),
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

double AxisMotion::within_largest(double velocity) const {
  const double largest = settings_.units.maximum_velocity();
  return std::clamp(velocity, -largest, largest);
}

control::RampLimits AxisMotion::search_limits(double velocity) const {
  const double acceleration = settings_.units.acceleration(objects_.homing_acceleration.get());
  return {.velocity = std::min(velocity, settings_.units.maximum_velocity()),
          .acceleration = acceleration,
          .deceleration = acceleration};
}

std::int64_t AxisMotion::move_to(std::int64_t target) {
  end_torque();
  cyclic_ = Cyclic::none;
  const std::int64_t allowed = between_limits(target);
  clamped_ = allowed != target;
  passed_target_ = allowed;
  const auto way = static_cast<double>(allowed - position());
  if (blocked_by_switch(way)) {
    stop_at_switch(way);
    holds_then_ = true;  // also out of a velocity loop
    return allowed;
  }
  hold_position();
  if (settings_.ramp.active) {
    ramp_.move_to(allowed + overrun(way), profile_limits());
    profile_ = Profile::positioning;
  } else {
    ramp_.follow_position(allowed, base::SimDuration(0));
    profile_ = Profile::immediate;
  }
  return allowed;
}

/// The target of profile position stays within limits that are moved under way.
void AxisMotion::keep_target_within_limits() {
  const std::int64_t allowed = between_limits(passed_target_);
  if (allowed == passed_target_) {
    return;
  }
  passed_target_ = allowed;
  clamped_ = true;
  ramp_.move_to(allowed, profile_limits());
}

/// How far behind a target the motor would come to rest that passes it with the end velocity.
std::int64_t AxisMotion::overrun(double way) const {
  const double deceleration = velocity_limits().deceleration;
  const double velocity = end_velocity();
  if (!settings_.behaviour.end_velocity_goes_on || clamped_ || velocity <= 0.0 ||
      deceleration <= 0.0) {
    return 0;
  }
  const std::int64_t distance = std::llround(velocity * velocity / (2.0 * deceleration));
  return way < 0.0 ? -distance : distance;
}

/// On the way to a point behind the target the motor brakes until it has the end velocity, on the
/// target, and keeps it.
void AxisMotion::go_on_behind_target() {
  const auto beyond = static_cast<double>(ramp_.target_position() - passed_target_);
  if (beyond == 0.0 || ramp_.phase() != control::RampPhase::decelerating ||
      velocity() * beyond <= 0.0) {
    return;
  }
  const double way = std::abs(static_cast<double>(ramp_.target_position() - position()));
  if (way > ramp_.braking_distance(velocity_limits()) + 1.0) {
    return;  // it turns round first
  }
  go_on(beyond);
}

void AxisMotion::go_on(double direction) {
  commanded_velocity_ = wanted_velocity_ = direction < 0.0 ? -end_velocity() : end_velocity();
  goes_on_ = true;
  if (blocked_by_switch(direction)) {
    stop_at_switch(direction);
    return;
  }
  stopping_ = false;
  ramp_.move_at_velocity(wanted_velocity_, velocity_limits());
  profile_ = Profile::velocity;
}

void AxisMotion::move_at_velocity(double velocity) {
  cyclic_ = Cyclic::none;
  take_up(velocity, true);
}

void AxisMotion::take_up(double velocity, bool on_profile) {
  end_torque();
  loop_without_torque_ = ControlLoop::velocity;
  commanded_velocity_ = velocity;
  wanted_velocity_ = within_largest(velocity);
  clamped_ = wanted_velocity_ != velocity;
  if (blocked_by_switch(wanted_velocity_)) {
    stop_at_switch(wanted_velocity_);
    return;
  }
  stopping_ = false;
  const auto command = [&](control::RampGenerator& ramp) {
    if (on_profile && settings_.ramp.active) {
      ramp.move_at_velocity(wanted_velocity_, velocity_limits());
    } else if (on_profile) {
      ramp.follow_velocity(wanted_velocity_, base::SimDuration(0));
    } else {
      ramp.follow_velocity(wanted_velocity_, objects_.interpolation_period());
    }
  };
  if (has_limits() && settings_.behaviour.stops_behind_software_limits) {
    if (limit_blocks(wanted_velocity_)) {
      stop_behind_limit(wanted_velocity_);
      return;
    }
  } else if (has_limits()) {
    control::RampGenerator trial = ramp_;
    command(trial);
    const double direction =
        limit_blocks(wanted_velocity_) ? wanted_velocity_ : limit_passed_by(trial, on_profile);
    if (direction != 0.0) {
      clamped_ = true;
      if (profile_ != Profile::to_limit || direction * limit_direction_ < 0.0) {
        travel_to_limit(direction, on_profile);
      }
      return;
    }
  }
  command(ramp_);
  profile_ = on_profile ? Profile::velocity : Profile::none;
}

bool AxisMotion::search_blocked(double direction, const PassedSwitches& passed) {
  end_torque();
  cyclic_ = Cyclic::none;
  profile_ = Profile::search;
  passed_ = passed;
  clamped_ = false;
  if (!blocked_by_switch(direction)) {
    return false;
  }
  if (!stopping()) {
    take_over_from_shaft();
    stop_on(switch_deceleration());
  }
  return true;
}

void AxisMotion::search_at_velocity(double velocity, const PassedSwitches& passed) {
  if (!search_blocked(velocity, passed)) {
    hold_position();
    ramp_.move_at_velocity(velocity, search_limits(settings_.units.maximum_velocity()));
  }
}

void AxisMotion::search_to(std::int64_t target, double velocity, const PassedSwitches& passed) {
  if (!search_blocked(static_cast<double>(target - position()), passed)) {
    hold_position();
    ramp_.move_to(target, search_limits(velocity));
  }
}

void AxisMotion::push_at_velocity(double velocity, const PassedSwitches& passed) {
  if (!search_blocked(velocity, passed)) {
    stopping_ = false;
    loop_without_torque_ = ControlLoop::velocity;
    ramp_.move_at_velocity(velocity, search_limits(settings_.units.maximum_velocity()));
  }
}

void AxisMotion::supervise() {
  cyclic_age_ += period_;
  switch (profile_) {
    case Profile::positioning:
      keep_target_within_limits();
      follow_profile_objects(profile_limits());
      go_on_behind_target();
      break;
    case Profile::velocity:
      if (within_largest(commanded_velocity_) != wanted_velocity_ && !goes_on_) {
        take_up(commanded_velocity_, true);
      }
      follow_profile_objects(velocity_limits());
      break;
    default:
      break;
  }
  if (!obey_limit_switches()) {
    watch_software_limits();
  }
  catch_up();
}

/// A servo motor cannot change its velocity by what 6083h and 6084h tell while they are 0: what is
/// under way keeps its ramps.
void AxisMotion::follow_profile_objects(const control::RampLimits& limits) {
  if (!measured_ || (limits.acceleration > 0.0 && limits.deceleration > 0.0)) {
    ramp_.set_limits(limits);
  }
}

}  // namespace stator::drive
