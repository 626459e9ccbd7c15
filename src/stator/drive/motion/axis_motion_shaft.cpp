// The shaft of an axis, and every stop, which is made from it.

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "stator/drive/motion/axis_motion.hpp"

namespace stator::drive {

namespace {

// A rotor that does not turn is followed to this many microsteps: less than a count of an encoder.
constexpr double kStandstill = 0.5;

/// For so long the shaft has to be slow, or where it is held, to stand: one that only passes
/// through 0 does not. Halls, of which a slow shaft passes few, need more.
constexpr base::SimDuration kStandingTime{2'000'000};
constexpr double kStandingIncrements = 0.1;  ///< at the standstill velocity
/// pps. Of a shaft that stands the filter leaves something, so that 0 would never be fallen below.
constexpr double kLeastStandstill = 2.0;
/// Standstill velocities up to which a shaft swings about the place where it is held, and stands;
/// and from which on it passes that place.
constexpr double kSwing = 2.0;
constexpr double kPassing = 20.0;
/// The position loop has a shaft in its place that is as near as this at the standstill velocity,
/// s.
constexpr double kInPlace = 0.02;
/// Of the demand's velocity, by which that of a shaft that follows it may differ: a sensor's noise,
/// and how late the loop is.
constexpr double kFollowedStandstills = 3.0;
constexpr double kFollowedShare = 0.02;
constexpr double kFollowedPeriods = 4.0;
/// A demand that is ahead of the shaft by more than it passes in this time means that the velocity
/// loop has lost its hold, s.
constexpr double kFarAhead = 0.25;
/// Time constant of the filter that takes the counts of an encoder out of the velocity, s.
constexpr double kVelocityFilter = 2e-3;

}  // namespace

void AxisMotion::follow_rotor(double deviation, double velocity) {
  // Fast enough to be a microstep or two away at the accelerations of a motor, slow enough not to
  // take the counts of an encoder for a velocity.
  constexpr double kTimeConstant = 4e-3;  // s
  const bool stands = velocity == 0.0 && std::abs(deviation) < kStandstill;
  ramp_.follow_velocity(stands ? 0.0 : velocity - deviation / kTimeConstant, base::SimDuration(0));
}

void AxisMotion::follow_shaft(const ShaftState& shaft) {
  const bool caught = free_ && !shaft.free;
  measured_ = true;
  shaft_position_ = shaft.position;
  shaft_velocity_ = shaft.velocity;
  filtered_velocity_ +=
      std::min(period_.seconds() / kVelocityFilter, 1.0) * (shaft.velocity - filtered_velocity_);
  standstill_ = std::max(shaft.standstill, kLeastStandstill);
  lead_ = shaft.lead;
  free_ = shaft.free;
  if (!is_slow() && !is_held(kSwing)) {
    standing_ = base::SimDuration(0);
  } else if (!stood()) {
    standing_ += period_;
  }
  if (free_) {
    stopping_ = false;
    if (ramp_.position().microsteps != shaft.position || !at_rest()) {
      ramp_.set_position(shaft.position);
    }
    return;
  }
  if (caught && !is_slow() && !stopping_) {
    brake(Braking::slow_down_ramp);
  }
  switch (loop()) {
    case ControlLoop::position:
      break;
    case ControlLoop::velocity:
      ramp_.shift(shaft.position - position());
      if (stopping_) {
        bring_demand_down();
      }
      if (stopping_ && at_rest() && is_slow()) {
        end_stop();
      }
      break;
    case ControlLoop::torque:
      rest_at(shaft.position, is_slow() ? 0.0 : shaft_velocity_);
      break;
  }
}

bool AxisMotion::is_slow() const {
  return std::abs(filtered_velocity_) < standstill_;
}

/// The position loop has the shaft where it is to be, as near as positioning counts as finished; it
/// may swing there with less than `velocity` standstill velocities.
bool AxisMotion::is_held(double velocity) const {
  const double near =
      std::min(static_cast<double>(settings_.position_end.value_or(PositionEnd{}).distance),
               kInPlace * standstill_);
  return !free_ && !stopping_ && loop() == ControlLoop::position &&
         static_cast<double>(std::abs(position() - shaft_position_)) <= near &&
         std::abs(filtered_velocity_) < velocity * standstill_;
}

bool AxisMotion::settled() const {
  return ramp_.at_rest() && (!measured_ || is_slow() || is_held(kPassing));
}

/// It has been slow, or held, for long enough.
bool AxisMotion::stood() const {
  return standing_ >= kStandingTime && standing_.seconds() * standstill_ >= kStandingIncrements;
}

bool AxisMotion::stands() const {
  return ramp_.at_rest() && (!measured_ || stood());
}

bool AxisMotion::stopping() const {
  const bool rests = !measured_ || (ramp_.at_rest() && !free_);
  return stopping_ || (ramp_.mode() == control::RampMode::stop && rests);
}

/// A stop never speeds the shaft up again: where something else has braked it below the demand, the
/// demand comes down to it.
void AxisMotion::bring_demand_down() {
  const double demand = std::abs(velocity());
  const double along = velocity() < 0.0 ? -filtered_velocity_ : filtered_velocity_;
  const double margin = std::max(kFollowedStandstills * standstill_, kFollowedShare * demand) +
                        kFollowedPeriods * period_.seconds() * stop_deceleration_;
  if (demand == 0.0 || along >= demand - margin) {
    return;
  }
  const double ahead = demand - std::max(along, 0.0);
  if (ahead > std::max(kPassing * standstill_, kFarAhead * demand)) {
    ++takeovers_;
  }
  rest_at(shaft_position_, along > 0.0 ? filtered_velocity_ : 0.0);
  ramp_.stop(stop_deceleration_);
}

void AxisMotion::end_stop() {
  stopping_ = false;
  if (holds_then_) {
    loop_without_torque_ = ControlLoop::position;
    ramp_.set_position(shaft_position_);
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

void AxisMotion::hold_position() {
  if (measured_ && loop_without_torque_ != ControlLoop::position) {
    ramp_.shift(std::llround(lead_ * velocity()));
  }
  loop_without_torque_ = ControlLoop::position;
  stopping_ = false;
}

void AxisMotion::settle(bool behind_stop) {
  if (settled()) {
    hold_position();
    held_back_ = behind_stop;
  } else if (!stopping()) {
    brake(Braking::slow_down_ramp);
  }
}

/// A stop begins: the velocity loop of a servo axis brings the shaft down from where and how fast
/// it is, whatever the demand was ahead or behind. A velocity that the shaft has followed goes on
/// without a step.
void AxisMotion::take_over_from_shaft() {
  if (!measured_ || stopping_) {
    return;
  }
  stopping_ = true;
  holds_then_ = loop() == ControlLoop::position;
  loop_without_torque_ = ControlLoop::velocity;
  if (std::abs(velocity() - shaft_velocity_) <=
      std::max(kFollowedStandstills * standstill_, kFollowedShare * std::abs(velocity()))) {
    const std::int64_t distance = settings_.position_end.value_or(PositionEnd{}).distance;
    if (is_slow() && std::abs(shaft_position_ - position()) > distance) {
      ++takeovers_;  // it is held up, and what pushed it on would make it leap when it comes free
    }
    ramp_.shift(shaft_position_ - position());
  } else {
    rest_at(shaft_position_, shaft_velocity_);
    ++takeovers_;
  }
}

void AxisMotion::stop_on(double deceleration) {
  stop_deceleration_ = deceleration;
  ramp_.stop(deceleration);
}

void AxisMotion::brake(Braking braking) {
  const bool searches = profile_ == Profile::search;
  const bool on_profile = profile_ == Profile::positioning || profile_ == Profile::velocity;
  control::RampLimits slow_down = velocity_limits();
  if (measured_ && on_profile && slow_down.deceleration <= 0.0) {
    slow_down = ramp_.limits();  // those that are in force
  }
  const double quick_stop = settings_.units.acceleration(objects_.quick_stop_deceleration.get());
  const double deceleration =
      braking == Braking::quick_stop_ramp ? quick_stop : slow_down.deceleration;
  if (torque_ && settings_.behaviour.stops_release_torque && deceleration <= 0.0 &&
      braking != Braking::at_once && braking != Braking::none) {
    torque_ = 0.0;  // there is no ramp to brake on: it coasts
    return;
  }
  profile_ = Profile::none;
  end_torque();
  if (braking == Braking::none) {
    return;
  }
  cyclic_ = Cyclic::none;
  held_back_ = true;
  take_over_from_shaft();
  switch (braking) {
    case Braking::none:
      break;
    case Braking::slow_down_ramp:
      if (searches) {
        stop_on(search_limits(settings_.units.maximum_velocity()).deceleration);
      } else if (on_profile) {
        ramp_.stop(slow_down);
        stop_deceleration_ = slow_down.deceleration;
      } else {
        stop_on(slow_down.deceleration);
      }
      break;
    case Braking::quick_stop_ramp:
      stop_on(quick_stop);
      break;
    case Braking::at_once:
      stop_on(0.0);
      break;
  }
}

}  // namespace stator::drive
