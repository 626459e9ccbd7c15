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
  const double deceleration =
      velocity() * direction > 0.0 ? switch_deceleration() : velocity_limits().deceleration;
  if (profile_ == Profile::immediate) {
    rest_at(shaft_position_, shaft_velocity_);
  }
  profile_ = Profile::none;
  ahead_ = {};
  if (ramp_.mode() != control::RampMode::stop || deceleration <= 0.0) {
    ramp_.stop(deceleration);
  }
}

double AxisMotion::switch_deceleration() const {
  if (!settings_.behaviour.slows_down_at_switches) {
    return settings_.ramp.stop_deceleration;
  }
  return profile_ == Profile::search ? search_limits(0.0).deceleration
                                     : velocity_limits().deceleration;
}

bool AxisMotion::limit_blocks(double direction) const {
  const auto upper = upper_limit();
  const auto lower = lower_limit();
  return (direction > 0.0 && upper && position() >= *upper) ||
         (direction < 0.0 && lower && position() <= *lower);
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
  const control::RampLimits limits = velocity_limits();
  const double way = std::abs(static_cast<double>(ramp_.target_position() - position()));
  if (way > ramp_.braking_distance(limits) + 1.0) {
    return;  // it turns round first
  }
  ramp_.move_at_velocity(beyond < 0.0 ? -end_velocity() : end_velocity(), limits);
  profile_ = Profile::velocity;
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

control::RampLimits AxisMotion::search_limits(double velocity) const {
  const double acceleration = settings_.units.acceleration(objects_.homing_acceleration.get());
  return {.velocity = std::min(velocity, settings_.units.maximum_velocity()),
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
  hold_position();
  const std::int64_t allowed =
      clamped(target, lower_limit().value_or(target), upper_limit().value_or(target));
  const auto way = static_cast<double>(allowed - position());
  if (blocked_by_switch(way)) {
    stop_at_switch(way);
  } else if (settings_.ramp.active) {
    passed_target_ = allowed;
    ramp_.move_to(allowed + overrun(way), profile_limits());
    profile_ = Profile::positioning;
  } else {
    ramp_.follow_position(allowed, base::SimDuration(0));
    profile_ = Profile::immediate;
  }
  return allowed;
}

void AxisMotion::follow_position(std::int64_t target) {
  end_torque();
  hold_position();
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
  loop_without_torque_ = ControlLoop::velocity;
  const double largest = settings_.units.maximum_velocity();
  wanted_velocity_ = std::clamp(velocity, -largest, largest);
  clamped_ = wanted_velocity_ != velocity;
  if (blocked_by_switch(wanted_velocity_)) {
    stop_at_switch(wanted_velocity_);
    return;
  }
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

void AxisMotion::stop_behind_limit(double direction) {
  // Away from the limit the way is free: only what still leads outward is braked.
  if (ramp_.mode() != control::RampMode::stop || velocity() * direction > 0.0) {
    brake(Braking::slow_down_ramp);
  }
  profile_ = Profile::none;
  clamped_ = true;
}

bool AxisMotion::search_blocked(double direction, const PassedSwitches& passed) {
  end_torque();
  hold_position();
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
    ramp_.move_at_velocity(velocity, search_limits(settings_.units.maximum_velocity()));
  }
}

void AxisMotion::search_to(std::int64_t target, double velocity, const PassedSwitches& passed) {
  if (!search_blocked(static_cast<double>(target - position()), passed)) {
    ramp_.move_to(target, search_limits(velocity));
  }
}

void AxisMotion::push_at_velocity(double velocity, const PassedSwitches& passed) {
  search_at_velocity(velocity, passed);
  loop_without_torque_ = ControlLoop::velocity;
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
  ahead_ = {};
  loop_without_torque_ = ControlLoop::velocity;
  torque_ = amperes;
}

void AxisMotion::follow_rotor(double deviation, double velocity) {
  // Fast enough to be a microstep or two away at the accelerations of a motor, slow enough not to
  // take the counts of an encoder for a velocity.
  constexpr double kTimeConstant = 4e-3;  // s
  const bool stands = velocity == 0.0 && std::abs(deviation) < kStandstill;
  ramp_.follow_velocity(stands ? 0.0 : velocity - deviation / kTimeConstant, base::SimDuration(0));
}

void AxisMotion::follow_shaft(std::int64_t position, double velocity, double standstill,
                              bool free) {
  shaft_position_ = position;
  shaft_velocity_ = std::abs(velocity) < standstill ? 0.0 : velocity;
  if (free) {
    if (ramp_.position().microsteps != position || !at_rest()) {
      ramp_.set_position(position);
    }
    return;
  }
  switch (loop()) {
    case ControlLoop::position:
      break;
    case ControlLoop::velocity:
      ramp_.shift(position - ramp_.position().microsteps);
      break;
    case ControlLoop::torque:
      rest_at(position, shaft_velocity_);
      break;
  }
}

void AxisMotion::rest_at(std::int64_t position, double velocity) {
  ramp_.set_position(position);
  if (velocity != 0.0) {
    ramp_.follow_velocity(velocity, base::SimDuration(0));
  }
}

void AxisMotion::rest_at_shaft() {
  end_torque();
  hold_position();
  profile_ = Profile::none;
  ramp_.set_position(shaft_position_);
}

void AxisMotion::brake(Braking braking) {
  if (profile_ == Profile::immediate && braking != Braking::none) {
    rest_at(shaft_position_, shaft_velocity_);
  }
  const double deceleration =
      braking == Braking::quick_stop_ramp
          ? settings_.units.acceleration(objects_.quick_stop_deceleration.get())
          : velocity_limits().deceleration;
  if (torque_ && settings_.behaviour.stops_release_torque && deceleration <= 0.0 &&
      braking != Braking::at_once && braking != Braking::none) {
    torque_ = 0.0;  // there is no ramp to brake on: it coasts
    return;
  }
  const bool searches = profile_ == Profile::search;
  const bool on_profile = profile_ == Profile::positioning || profile_ == Profile::velocity;
  profile_ = Profile::none;
  end_torque();
  switch (braking) {
    case Braking::none:
      break;
    case Braking::slow_down_ramp:
      if (searches) {
        ramp_.stop(search_limits(settings_.units.maximum_velocity()).deceleration);
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
    go_on_behind_target();
  } else if (profile_ == Profile::velocity) {
    ramp_.set_limits(velocity_limits());
  }
  if (!obey_limit_switches()) {
    watch_software_limits();
  }
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
  if (!switch_blocks(velocity())) {
    if (!switch_blocks(blocked_direction_)) {
      blocked_direction_ = 0.0;
    }
    return false;
  }
  if (settings_.behaviour.slows_down_at_switches && turns_back()) {
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
