// Targets that a master commands anew in every cycle, and how an axis that was held back comes
// back to them.

#include <algorithm>
#include <cmath>

#include "stator/drive/motion/axis_motion.hpp"

namespace stator::drive {

bool AxisMotion::follows_target() const {
  // A velocity that was cut down to the largest one is followed all the same.
  const bool cut_down = cyclic_ == Cyclic::velocity && profile_ != Profile::to_limit &&
                        wanted_velocity_ != commanded_velocity_;
  return !held_back_ && blocked_direction_ == 0.0 && (!clamped_ || cut_down);
}

void AxisMotion::follow_position(std::int64_t target) {
  end_torque();
  profile_ = Profile::none;
  note_cyclic(target);
  cyclic_allowed_ = within_limits(target);
  clamped_ = cyclic_allowed_ != target;
  if (held_back_) {
    return;  // catch_up() takes it
  }
  hold_position();
  const auto way = static_cast<double>(cyclic_allowed_ - position());
  if (blocked_by_switch(way)) {
    stop_at_switch(way);
  } else {
    ramp_.follow_position(cyclic_allowed_, objects_.interpolation_period());
  }
}

void AxisMotion::note_cyclic(std::int64_t target) {
  const std::int64_t before = cyclic_ == Cyclic::position ? cyclic_target_ : position();
  cyclic_way_ = static_cast<double>(target - before);
  cyclic_age_ = base::SimDuration(0);
  cyclic_target_ = target;
  cyclic_ = Cyclic::position;
}

/// Outside the limits the axis may stay or return.
std::int64_t AxisMotion::within_limits(std::int64_t target) const {
  return std::max(std::min(target, std::max(upper_limit().value_or(target), position())),
                  std::min(lower_limit().value_or(target), position()));
}

void AxisMotion::follow_velocity(double velocity) {
  cyclic_ = Cyclic::velocity;
  take_up(velocity, held_back_ && has_ramp());
}

bool AxisMotion::has_ramp() const {
  const control::RampLimits limits = velocity_limits();
  return limits.acceleration > 0.0 && limits.deceleration > 0.0;
}

void AxisMotion::catch_up() {
  switch (cyclic_) {
    case Cyclic::none:
      break;
    case Cyclic::position:
      catch_up_position();
      break;
    case Cyclic::velocity:
      catch_up_velocity();
      break;
  }
}

void AxisMotion::catch_up_velocity() {
  if (within_largest(commanded_velocity_) != wanted_velocity_) {
    held_back_ = true;  // another 607Fh is in force
    take_up(commanded_velocity_, has_ramp());
  }
  if (!held_back_ || blocked_direction_ != 0.0 || profile_ == Profile::to_limit) {
    return;
  }
  if (profile_ == Profile::none && ramp_.mode() == control::RampMode::stop) {
    take_up(commanded_velocity_, has_ramp());
  }
  if (velocity() == wanted_velocity_ || !has_ramp()) {
    held_back_ = false;
    profile_ = Profile::none;
    ramp_.follow_velocity(wanted_velocity_, base::SimDuration(0));
  }
}

void AxisMotion::catch_up_position() {
  const std::int64_t allowed = within_limits(cyclic_target_);
  if (!held_back_ && allowed == cyclic_allowed_) {
    return;
  }
  held_back_ = true;
  cyclic_allowed_ = allowed;
  clamped_ = allowed != cyclic_target_;
  const double way = static_cast<double>(allowed - position()) - ramp_.position().fraction;
  if (blocked_by_switch(way)) {
    stop_at_switch(way);
    return;
  }
  if (stopping_) {
    return;
  }
  hold_position();
  approach(way);
}

/// Closes in on a target that may move: what is left of the way has to be enough to lose the
/// velocity relative to the target's, which is that of its interpolation.
void AxisMotion::approach(double way) {
  control::RampLimits limits = velocity_limits();
  if (clamped_ && has_ramp()) {
    // A limit stands still: the ramp ends on it exactly.
    const double fastest = profile_velocity();
    limits.velocity = fastest > 0.0 ? std::min(fastest, limits.velocity) : limits.velocity;
    ramp_.move_to(cyclic_allowed_, limits);
    held_back_ = !ramp_.target_reached();
    return;
  }
  const base::SimDuration interpolation = objects_.interpolation_period();
  const double time = period_.seconds();
  const bool moves = !clamped_ && cyclic_age_ < interpolation;
  const double target_velocity = moves ? cyclic_way_ / interpolation.seconds() : 0.0;
  // Where the interpolation of the master's targets is by now.
  const double rest =
      way - (moves ? target_velocity * (interpolation - cyclic_age_).seconds() : 0.0);
  const double change = limits.deceleration * time;
  const double difference = std::abs(velocity() - target_velocity);
  if (!has_ramp() || (difference <= change && std::abs(rest) <= std::max(1.0, change * time))) {
    held_back_ = false;
    ramp_.follow_position(cyclic_allowed_,
                          has_ramp() && moves ? interpolation - cyclic_age_ : interpolation);
    return;
  }
  const double half = 0.5 * change;
  double closing = std::sqrt(2.0 * limits.deceleration * std::abs(rest) + half * half) - half;
  closing = std::min(closing, std::abs(rest) / time);
  if (const double fastest = profile_velocity(); fastest > 0.0) {
    closing = std::min(closing, fastest);
  }
  const double wanted = within_largest(target_velocity + std::copysign(closing, rest));
  const bool gains = wanted * velocity() >= 0.0 && std::abs(wanted) > std::abs(velocity());
  const double step = (gains ? limits.acceleration : limits.deceleration) * time;
  ramp_.follow_velocity(std::clamp(wanted, velocity() - step, velocity() + step), period_);
}

}  // namespace stator::drive
