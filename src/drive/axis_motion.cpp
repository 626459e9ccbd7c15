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

constexpr std::int64_t within_counter(std::int64_t value) {
  return std::clamp<std::int64_t>(value, kNoMinimum, kNoMaximum);
}

}  // namespace

std::int64_t AxisMotion::turn() const {
  return position() - static_cast<std::int32_t>(position());
}

std::int64_t AxisMotion::absolute(std::int32_t object) const {
  return turn() + object;
}

std::int64_t AxisMotion::cyclic(std::int32_t target, std::int32_t offset) const {
  const auto nearest = [this](std::int64_t lower_bits) {
    return position() + static_cast<std::int32_t>(lower_bits - position());
  };
  return has_limits() ? nearest(target) + offset : nearest(std::int64_t{target} + offset);
}

bool AxisMotion::has_limits() const {
  return objects_.minimum_position.get() != kNoMinimum ||
         objects_.maximum_position.get() != kNoMaximum;
}

std::optional<std::int64_t> AxisMotion::lower_limit() const {
  if (!has_limits()) {
    return std::nullopt;
  }
  const std::int64_t minimum = objects_.minimum_position.get();
  const std::int64_t offset = minimum == kNoMinimum ? 0 : objects_.home_offset.get();
  return turn() + within_counter(minimum - offset);
}

std::optional<std::int64_t> AxisMotion::upper_limit() const {
  if (!has_limits()) {
    return std::nullopt;
  }
  const std::int64_t maximum = objects_.maximum_position.get();
  const std::int64_t offset = maximum == kNoMaximum ? 0 : objects_.home_offset.get();
  return turn() + within_counter(maximum - offset);
}

std::int64_t AxisMotion::clamped(std::int64_t target, std::int64_t lower, std::int64_t upper) {
  const std::int64_t result = std::max(std::min(target, upper), lower);
  clamped_ = result != target;
  return result;
}

bool AxisMotion::switch_blocks(double direction) const {
  const PassedSwitches passed = profile_ == Profile::search ? passed_ : PassedSwitches{};
  return (direction > 0.0 && conditions_.positive_limit_switch && !passed.positive_limit) ||
         (direction < 0.0 && conditions_.negative_limit_switch && !passed.negative_limit);
}

bool AxisMotion::blocked_by_switch(double direction) {
  blocked_direction_ = switch_blocks(direction) ? direction : 0.0;
  return blocked_direction_ != 0.0;
}

void AxisMotion::stop_at_switch(double direction) {
  profile_ = Profile::none;
  const double deceleration = velocity() * direction > 0.0 ? settings_.ramp.stop_deceleration
                                                           : velocity_limits().deceleration;
  if (ramp_.mode() != control::RampMode::stop || deceleration <= 0.0) {
    ramp_.stop(deceleration);
  }
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

control::RampLimits AxisMotion::limits_before_limit(bool on_profile) const {
  control::RampLimits limits = velocity_limits();
  if (!on_profile) {
    limits = {.acceleration = limits.deceleration, .deceleration = limits.deceleration};
  }
  return limits;
}

std::int64_t AxisMotion::move_to(std::int64_t target) {
  end_torque();
  const std::int64_t allowed =
      clamped(target, lower_limit().value_or(target), upper_limit().value_or(target));
  const auto way = static_cast<double>(allowed - position());
  if (blocked_by_switch(way)) {
    stop_at_switch(way);
  } else {
    ramp_.move_to(allowed, profile_limits());
    profile_ = Profile::positioning;
  }
  return allowed;
}

void AxisMotion::follow_position(std::int64_t target) {
  end_torque();
  profile_ = Profile::none;
  const std::int64_t allowed = clamped(target, std::min(lower_limit().value_or(target), position()),
                                       std::max(upper_limit().value_or(target), position()));
  const auto way = static_cast<double>(allowed - position());
  if (blocked_by_switch(way)) {
    stop_at_switch(way);
  } else {
    ramp_.follow_position(allowed, objects_.interpolation_period());
  }
}

void AxisMotion::move_at_velocity(double velocity) {
  take_up(velocity, true);
}

void AxisMotion::follow_velocity(double velocity) {
  take_up(velocity, false);
}

void AxisMotion::take_up(double velocity, bool on_profile) {
  end_torque();
  wanted_velocity_ =
      std::clamp(velocity, -MotionUnits::kMaximumVelocity, MotionUnits::kMaximumVelocity);
  clamped_ = wanted_velocity_ != velocity;
  if (blocked_by_switch(wanted_velocity_)) {
    stop_at_switch(wanted_velocity_);
    return;
  }
  const auto command = [&](control::RampGenerator& ramp) {
    if (on_profile) {
      ramp.move_at_velocity(wanted_velocity_, velocity_limits());
    } else {
      ramp.follow_velocity(wanted_velocity_, objects_.interpolation_period());
    }
  };
  if (has_limits()) {
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

/// Direction of the software limit that `ramp` runs over unless the axis brakes before the next
/// control period ends; 0 = none.
double AxisMotion::limit_passed_by(const control::RampGenerator& ramp, bool on_profile) const {
  control::RampGenerator later = ramp;
  // Two periods ahead: this one and the one after, in which it would be too late.
  later.advance(period_ + period_);
  const double direction = later.velocity() < 0.0 ? -1.0 : 1.0;
  const auto limit = direction > 0.0 ? upper_limit() : lower_limit();
  if (later.velocity() == 0.0 || !limit ||
      (on_profile && ramp.target_velocity() * direction <= 0.0)) {
    return 0.0;  // the last: it brakes as hard as it may already
  }
  const double way = direction * static_cast<double>(*limit - later.position().microsteps);
  // A microstep more for the fraction that the integer position leaves out.
  const bool late = way <= later.braking_distance(limits_before_limit(on_profile)) + 1.0;
  return late ? direction : 0.0;
}

void AxisMotion::travel_to_limit(double direction, bool on_profile) {
  control::RampLimits limits = limits_before_limit(on_profile);
  const double sign = direction < 0.0 ? -1.0 : 1.0;
  const std::int64_t limit = (sign > 0.0 ? upper_limit() : lower_limit()).value_or(position());
  const bool ahead = sign * static_cast<double>(limit - position()) > 0.0;
  limits.velocity = sign * velocity();
  clamped_ = true;
  if (torque_) {
    profile_ = Profile::none;
    hold_against(direction);
  } else {
    profile_ = Profile::to_limit;
    limit_direction_ = direction;
    limits.velocity = std::max(limits.velocity, sign * wanted_velocity_);
  }
  if (ahead && limits.deceleration > 0.0) {
    ramp_.move_to(limit, limits);
  } else {
    ramp_.stop(limits);
  }
}

bool AxisMotion::search_blocked(double direction, const PassedSwitches& passed) {
  end_torque();
  profile_ = Profile::search;
  passed_ = passed;
  clamped_ = false;
  if (!blocked_by_switch(direction)) {
    return false;
  }
  if (ramp_.mode() != control::RampMode::stop) {
    ramp_.stop(settings_.ramp.stop_deceleration);
  }
  return true;
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
  clamped_ = true;
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
  clamped_ = false;
  blocked_direction_ = 0.0;
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
  const bool on_profile = profile_ == Profile::positioning || profile_ == Profile::velocity;
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

void AxisMotion::supervise() {
  if (profile_ == Profile::positioning) {
    ramp_.set_limits(profile_limits());
  } else if (profile_ == Profile::velocity) {
    ramp_.set_limits(velocity_limits());
  }
  if (!obey_limit_switches()) {
    watch_software_limits();
  }
}

bool AxisMotion::obey_limit_switches() {
  if (!switch_blocks(velocity())) {
    if (!switch_blocks(blocked_direction_)) {
      blocked_direction_ = 0.0;
    }
    return false;
  }
  blocked_direction_ = velocity();
  if (torque_) {
    hold_against(velocity());
  }
  stop_at_switch(velocity());
  return true;
}

void AxisMotion::watch_software_limits() {
  if (!has_limits()) {
    return;
  }
  if (profile_ == Profile::to_limit) {
    // Away from the limit, but so slowly by 60C2h that it could not be taken at once.
    if (limit_direction_ * wanted_velocity_ <= 0.0) {
      take_up(wanted_velocity_, false);
    }
    return;
  }
  const bool on_profile = profile_ == Profile::velocity;
  if (!on_profile && ramp_.mode() != control::RampMode::follow_velocity) {
    return;
  }
  if (const double direction = limit_passed_by(ramp_, on_profile); direction != 0.0) {
    travel_to_limit(direction, on_profile);
  }
}

}  // namespace stator::drive
