#include "stator/control/motion_controller/motion_controller_ramp.hpp"

#include <algorithm>
#include <cmath>

#include "stator/control/motion_controller/motion_controller_units.hpp"
#include "stator/control/rounding.hpp"

namespace stator::control::motion_controller {

namespace {

constexpr double kAtOnce = 1e12;  // pps/s; what RampLimits can express at most
constexpr std::uint32_t kMaximumVelocity = 0x7FFF'FFFF;
constexpr std::uint32_t kMaximumAcceleration = 0xFF'FFFF;
constexpr double kFastest = 2'147'483'648.0 * kVelocityUnit;  // pps

double rate(std::uint32_t acceleration) {
  return std::clamp(acceleration, 1U, kMaximumAcceleration) * kAccelerationUnit;
}

/// `to` - `from` as a chip's subtraction gives it.
std::int32_t wrapped_difference(std::int32_t from, std::int32_t to) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(to) -
                                   static_cast<std::uint32_t>(from));
}

}  // namespace

MotionControllerRamp::MotionControllerRamp() {
  configure(settings_, limits_, false);
}

void MotionControllerRamp::configure(const RampSettings& settings, const PositionLimits& limits,
                                     bool soft_stop) {
  settings_ = settings;
  limits_ = limits;
  soft_stop_ = soft_stop;
  const std::uint8_t bow = std::min(settings.bow, kMaximumBow);
  positioning_ =
      linear_limits(std::min(settings.maximum_velocity, kMaximumVelocity) * kVelocityUnit);
  if (bow > 0) {
    positioning_.shape = RampShape::s_shaped;
    positioning_.jerk.fill(bow_value(bow) * kBowUnit);
  }
  turning_ = positioning_;
  turning_.velocity = kFastest;
  stop_deceleration_ = rate(settings.stop_deceleration);
  replan();
}

RampLimits MotionControllerRamp::linear_limits(double velocity) const {
  return {.velocity = velocity,
          .acceleration = rate(settings_.acceleration),
          .deceleration = rate(settings_.deceleration)};
}

void MotionControllerRamp::move_to(std::int32_t target) {
  target_position_ = target;
  mode_ = Mode::positioning;
  aim();
  replan();
}

void MotionControllerRamp::rotate(std::int32_t velocity) {
  mode_ = Mode::velocity;
  target_velocity_ = velocity;
  replan();
}

void MotionControllerRamp::set_target_velocity(std::int32_t velocity) {
  target_velocity_ = velocity;
  if (mode_ == Mode::velocity) {
    replan();
  }
}

void MotionControllerRamp::set_mode(Mode mode) {
  if (mode == Mode::hold && mode_ != Mode::hold) {
    held_velocity_ = ramp_.velocity();
  }
  mode_ = mode;
  aim();
  replan();
}

void MotionControllerRamp::set_position(std::int32_t position) {
  ramp_.shift(wrapped_difference(this->position(), position));
  aim();
  replan();
}

void MotionControllerRamp::stop_at_once() {
  mode_ = Mode::velocity;
  target_velocity_ = 0;
  ramp_.stop_at_once();
  replan();
}

void MotionControllerRamp::ignore_limits(bool ignore) {
  limits_ignored_ = ignore;
  replan();
}

void MotionControllerRamp::aim() {
  goal_ = unwrapped_position() + wrapped_difference(position(), target_position_);
}

std::int32_t MotionControllerRamp::velocity() const {
  return saturated(nearest_integer(ramp_.velocity() * (1.0 / kVelocityUnit)));
}

std::int32_t MotionControllerRamp::acceleration() const {
  return saturated(nearest_integer(ramp_.acceleration() * (1.0 / kAccelerationUnit)));
}

bool MotionControllerRamp::bow_too_large() const {
  return bow_value(std::min(settings_.bow, kMaximumBow)) >
         std::min(settings_.acceleration, settings_.deceleration);
}

/// Microsteps to the right limit; not positive on or beyond it.
double MotionControllerRamp::room_right() const {
  return static_cast<double>(std::int64_t{limits_.right} - position()) - ramp_.position().fraction;
}

double MotionControllerRamp::room_left() const {
  return static_cast<double>(std::int64_t{position()} - limits_.left) + ramp_.position().fraction;
}

bool MotionControllerRamp::right_blocked() const {
  return stops_.right || (limits_.right_enabled && !limits_ignored_ && room_right() <= 0.0);
}

bool MotionControllerRamp::left_blocked() const {
  return stops_.left || (limits_.left_enabled && !limits_ignored_ && room_left() <= 0.0);
}

double MotionControllerRamp::wanted_direction() const {
  switch (mode_) {
    case Mode::positioning:
      return distance(ramp_.position(), {goal_, 0.0});
    case Mode::velocity:
      return target_velocity_;
    case Mode::hold:
      break;
  }
  return held_velocity_;
}

std::int64_t MotionControllerRamp::goal_within_limits() const {
  const std::int64_t offset = unwrapped_position() - position();
  std::int64_t goal = goal_;
  if (limits_ignored_) {
    return goal;
  }
  if (limits_.right_enabled && room_right() > 0.0) {
    goal = std::min(goal, offset + limits_.right);
  }
  if (limits_.left_enabled && room_left() > 0.0) {
    goal = std::max(goal, offset + limits_.left);
  }
  return goal;
}

/// Plans anew from the present motion, as everything that bounds it stands now.
void MotionControllerRamp::replan() {
  braking_ = false;
  approaching_ = false;
  const double velocity = ramp_.velocity();
  if ((velocity > 0.0 && right_blocked()) || (velocity < 0.0 && left_blocked())) {
    brake();
    return;
  }
  const double wanted = wanted_direction();
  if ((wanted > 0.0 && right_blocked()) || (wanted < 0.0 && left_blocked())) {
    ramp_.stop(turning_);
    return;
  }
  follow();
}

void MotionControllerRamp::follow() {
  switch (mode_) {
    case Mode::positioning:
      ramp_.move_to(goal_within_limits(), positioning_);
      return;
    case Mode::velocity:
      ramp_.move_at_velocity(target_velocity_ * kVelocityUnit, turning_);
      return;
    case Mode::hold:
      ramp_.move_at_velocity(held_velocity_, linear_limits(kFastest));
      return;
  }
}

void MotionControllerRamp::brake() {
  braking_ = true;
  ramp_.stop(soft_stop_ ? stop_deceleration_ : 0.0);
}

void MotionControllerRamp::advance(const StopConditions& stops, base::SimDuration period) {
  const double velocity = ramp_.velocity();
  if (stops != stops_) {
    stops_ = stops;
    replan();
  }
  if (velocity != 0.0) {
    watch(velocity, period);
  } else if (braking_ || approaching_) {
    replan();  // what is wanted may lead the other way
  }
  ramp_.advance(period);
}

/// Watches for stops that a plan does not consider: its way back, its overshoot or its cruise may
/// lead into one.
void MotionControllerRamp::watch(double velocity, base::SimDuration period) {
  if (braking_) {
    return;
  }
  const bool right = velocity > 0.0;
  if (right ? right_blocked() : left_blocked()) {
    replan();
  } else if (!approaching_) {
    look_ahead(velocity, period);
  }
}

/// In velocity and hold mode: begins to approach a limit one period before braking must begin, at
/// the velocity there will be then.
void MotionControllerRamp::look_ahead(double velocity, base::SimDuration period) {
  const bool right = velocity > 0.0;
  const bool limited = right ? limits_.right_enabled : limits_.left_enabled;
  if (!limited || limits_ignored_ || mode_ == Mode::positioning) {
    return;
  }
  const double room = right ? room_right() : room_left();
  const double seconds = period.seconds();
  const double next = std::fabs(velocity) + turning_.acceleration * seconds;
  const double deceleration = soft_stop_ ? stop_deceleration_ : kAtOnce;
  if (room <= 2.0 * seconds * next + 0.5 * next * next / deceleration) {
    approach_limit(velocity, room);
  }
}

/// The rest of the way to a limit, in closed form, so that it ends on the limit.
void MotionControllerRamp::approach_limit(double velocity, double room) {
  approaching_ = true;
  const double wanted = mode_ == Mode::hold ? held_velocity_ : target_velocity_ * kVelocityUnit;
  const bool away = wanted * velocity < 0.0;
  const double braking = 0.5 * velocity * velocity / turning_.deceleration;
  if (away && braking < room) {
    approaching_ = false;  // it turns before it gets there
    return;
  }
  RampLimits limits = linear_limits(std::max(std::fabs(velocity), std::fabs(wanted)));
  limits.deceleration = soft_stop_ ? stop_deceleration_ : kAtOnce;
  const std::int64_t offset = unwrapped_position() - position();
  ramp_.move_to(offset + (velocity > 0.0 ? limits_.right : limits_.left), limits);
}

}  // namespace stator::control::motion_controller
