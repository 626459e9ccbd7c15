// Limit switches and software position limits, which hold for all modes.

#include <algorithm>
#include <cmath>
#include <limits>

#include "stator/drive/motion/axis_motion.hpp"

namespace stator::drive {

namespace {

constexpr std::int32_t kNoMinimum = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kNoMaximum = std::numeric_limits<std::int32_t>::max();

constexpr std::int64_t within_counter(std::int64_t value) {
  return std::clamp<std::int64_t>(value, kNoMinimum, kNoMaximum);
}

}  // namespace

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
  return turn() + unscaled(within_counter(minimum - offset));
}

std::optional<std::int64_t> AxisMotion::upper_limit() const {
  if (!has_limits()) {
    return std::nullopt;
  }
  const std::int64_t maximum = objects_.maximum_position.get();
  const std::int64_t offset = maximum == kNoMaximum ? 0 : objects_.home_offset.get();
  return turn() + unscaled(within_counter(maximum - offset));
}

std::int64_t AxisMotion::between_limits(std::int64_t target) const {
  return std::max(std::min(target, upper_limit().value_or(target)), lower_limit().value_or(target));
}

bool AxisMotion::limit_blocks(double direction) const {
  const auto upper = upper_limit();
  const auto lower = lower_limit();
  return (direction > 0.0 && upper && position() >= *upper) ||
         (direction < 0.0 && lower && position() <= *lower);
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

double AxisMotion::switch_deceleration() const {
  if (!settings_.behaviour.slows_down_at_switches) {
    return settings_.ramp.stop_deceleration;
  }
  return profile_ == Profile::search ? search_limits(0.0).deceleration
                                     : velocity_limits().deceleration;
}

void AxisMotion::stop_at_switch(double direction) {
  const double deceleration =
      velocity() * direction > 0.0 ? switch_deceleration() : velocity_limits().deceleration;
  profile_ = Profile::none;
  ahead_ = {};
  held_back_ = true;
  if (!stopping() || (!measured_ && deceleration <= 0.0)) {
    take_over_from_shaft();
    stop_on(deceleration);
  }
}

/// The demand is so far ahead of the shaft of a servo axis that the position loop drives it on.
bool AxisMotion::pulls(double direction) const {
  const std::int64_t tolerance = settings_.position_end.value_or(PositionEnd{}).distance;
  return measured_ && loop() == ControlLoop::position &&
         direction * static_cast<double>(position() - shaft_position_) >
             static_cast<double>(tolerance);
}

/// In which the axis moves, or is about to move, into a limit switch that is pressed; 0 = none.
double AxisMotion::way_into_switch() const {
  for (const double direction : {1.0, -1.0}) {
    if (switch_blocks(direction) && (velocity() * direction > 0.0 || pulls(direction))) {
      return direction;
    }
  }
  return 0.0;
}

/// The profile under way leads against the present motion, so it begins with the slow down ramp.
bool AxisMotion::turns_back() const {
  switch (profile_) {
    case Profile::positioning:
      return static_cast<double>(passed_target_ - position()) * velocity() < 0.0;
    case Profile::velocity:
      return wanted_velocity_ * velocity() < 0.0;
    default:
      return false;
  }
}

bool AxisMotion::obey_limit_switches() {
  const double direction = way_into_switch();
  if (direction == 0.0) {
    if (!switch_blocks(blocked_direction_)) {
      blocked_direction_ = 0.0;
    }
    return false;
  }
  if (settings_.behaviour.slows_down_at_switches && turns_back() && !pulls(direction)) {
    return false;
  }
  blocked_direction_ = direction;
  if (torque_) {
    hold_against(direction);
  }
  stop_at_switch(direction);
  return true;
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
  const double way = direction * static_cast<double>(*limit - later.position().microsteps) -
                     lead_way(later.velocity());
  // A microstep more for the fraction that the integer position leaves out.
  const bool late = way <= later.braking_distance(limits_before_limit(on_profile)) + 1.0;
  return late ? direction : 0.0;
}

control::RampLimits AxisMotion::limits_before_limit(bool on_profile) const {
  control::RampLimits limits = velocity_limits();
  if (!on_profile) {
    limits = {.acceleration = limits.deceleration, .deceleration = limits.deceleration};
  }
  return limits;
}

/// By which the demand goes ahead of the shaft when the position loop takes over at `velocity`.
double AxisMotion::lead_way(double velocity) const {
  return loop() == ControlLoop::position ? 0.0 : lead_ * std::abs(velocity);
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
    travelled_limit_ = sign > 0.0 ? upper_limit() : lower_limit();
    limits.velocity = std::max(limits.velocity, sign * wanted_velocity_);
  }
  if (ahead && limits.deceleration > 0.0) {
    hold_position();
    ramp_.move_to(limit, limits);
  } else {
    take_over_from_shaft();
    stop_deceleration_ = limits.deceleration;
    ramp_.stop(limits);
  }
}

void AxisMotion::stop_behind_limit(double direction) {
  // Away from the limit the way is free: only what still leads outward is braked.
  if (ramp_.mode() != control::RampMode::stop || velocity() * direction > 0.0) {
    brake(Braking::slow_down_ramp);
  }
  profile_ = Profile::none;
  clamped_ = true;
}

void AxisMotion::watch_software_limits() {
  if (!has_limits()) {
    if (profile_ == Profile::to_limit) {
      resume_velocity();  // the limit has gone
    }
    return;
  }
  if (profile_ == Profile::to_limit) {
    const auto limit = limit_direction_ > 0.0 ? upper_limit() : lower_limit();
    // Away from the limit, but so slowly by 60C2h that it could not be taken at once; or the limit
    // is another one.
    if (limit_direction_ * wanted_velocity_ <= 0.0 || limit != travelled_limit_) {
      resume_velocity();
    }
    return;
  }
  const bool on_profile = profile_ == Profile::velocity;
  if (!on_profile && ramp_.mode() != control::RampMode::follow_velocity) {
    return;
  }
  if (settings_.behaviour.stops_behind_software_limits) {
    if (limit_blocks(velocity())) {
      stop_behind_limit(velocity());
    }
    return;
  }
  if (const double direction = limit_passed_by(ramp_, on_profile); direction != 0.0) {
    travel_to_limit(direction, on_profile);
  }
}

/// The way to a software limit ends: the velocity commanded last is in force again.
void AxisMotion::resume_velocity() {
  const bool cyclic = cyclic_ == Cyclic::velocity;
  const bool ahead = limit_direction_ * wanted_velocity_ > 0.0;
  profile_ = Profile::none;
  held_back_ = cyclic && ahead;
  take_up(commanded_velocity_, !cyclic || ahead);
}

void AxisMotion::hold_against(double direction) {
  clamped_ = true;
  torque_.reset();
  held_direction_ = direction < 0.0 ? -1.0 : 1.0;
  held_limit_ = direction > 0.0 ? upper_limit() : lower_limit();
}

/// What held a torque against held_direction_ is there no more.
bool AxisMotion::hold_has_ended() const {
  const auto limit = held_direction_ > 0.0 ? upper_limit() : lower_limit();
  return !switch_blocks(held_direction_) &&
         (limit != held_limit_ || !limit_blocks(held_direction_));
}

void AxisMotion::apply_torque(double amperes) {
  cyclic_ = Cyclic::none;
  if (held_direction_ != 0.0) {
    if (!stands() || (amperes * held_direction_ >= 0.0 && !hold_has_ended())) {
      return;
    }
    held_direction_ = 0.0;
  }
  // A load can drive the shaft into a limit that the torque does not point to.
  for (const double direction : {amperes, amperes == 0.0 ? velocity() : 0.0}) {
    if (switch_blocks(direction) || limit_blocks(direction)) {
      brake(Braking::slow_down_ramp);
      hold_against(direction);
      return;
    }
  }
  clamped_ = false;
  blocked_direction_ = 0.0;
  profile_ = Profile::none;
  ahead_ = {};
  stopping_ = false;
  loop_without_torque_ = ControlLoop::velocity;
  torque_ = amperes;
}

}  // namespace stator::drive
