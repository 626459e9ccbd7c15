#pragma once

#include <algorithm>
#include <cmath>

namespace stator::control::tests {

/// A trapezoid from any moving start, written for itself: event after event in long double, each
/// found by its own equation. Units of the reader's choice.
class TrapezoidReference {
 public:
  long double maximum_velocity = 0.0L;
  long double acceleration = 0.0L;
  long double deceleration = 0.0L;

  void set_state(long double position, long double velocity) {
    position_ = position;
    velocity_ = velocity;
  }
  void move_to(long double target) {
    positioning_ = true;
    target_ = target;
  }
  void rotate(long double velocity) {
    positioning_ = false;
    target_ = velocity;
  }

  void advance(long double time) {
    while (time > 0.0L) {
      const Phase phase = positioning_ ? next_of_positioning() : next_of_velocity();
      const long double part = std::min(time, phase.duration);
      position_ += velocity_ * part + 0.5L * phase.acceleration * part * part;
      velocity_ += phase.acceleration * part;
      if (part == phase.duration) {
        velocity_ = phase.final_velocity;
        position_ = phase.ends_on_target ? target_ : position_;
      }
      time -= part;
    }
  }

  [[nodiscard]] long double position() const { return position_; }
  [[nodiscard]] long double velocity() const { return velocity_; }

 private:
  struct Phase {
    long double duration;
    long double acceleration;
    long double final_velocity;
    bool ends_on_target = false;
  };
  static constexpr long double kForEver = 1e30L;

  [[nodiscard]] Phase change_speed(long double speed, long double direction) const {
    const long double change = speed - std::fabs(velocity_);
    const long double rate = change > 0.0L ? acceleration : deceleration;
    return {std::fabs(change) / rate, direction * (change > 0.0L ? rate : -rate),
            direction * speed};
  }

  [[nodiscard]] Phase next_of_velocity() const {
    if (velocity_ == target_) {
      return {kForEver, 0.0L, velocity_};
    }
    if (velocity_ * target_ < 0.0L || (target_ == 0.0L && velocity_ != 0.0L)) {
      return change_speed(0.0L, velocity_ < 0.0L ? -1.0L : 1.0L);
    }
    return change_speed(std::fabs(target_), target_ < 0.0L ? -1.0L : 1.0L);
  }

  [[nodiscard]] Phase next_of_positioning() const {
    const long double way = target_ - position_;
    if (velocity_ == 0.0L && way == 0.0L) {
      return {kForEver, 0.0L, 0.0L};
    }
    const long double direction =
        velocity_ != 0.0L ? (velocity_ < 0.0L ? -1.0L : 1.0L) : (way < 0.0L ? -1.0L : 1.0L);
    const long double speed = std::fabs(velocity_);
    const long double length = direction * way;
    const long double braking = 0.5L * speed * speed / deceleration;
    const long double rounding = 1e-17L * (braking + std::fabs(position_)) + 1e-15L;
    if (length < braking + rounding) {
      Phase phase = change_speed(0.0L, direction);
      phase.ends_on_target = length > braking - rounding;
      if (phase.ends_on_target && phase.duration == 0.0L) {
        phase.duration = 1e-30L;
      }
      return phase;
    }
    if (speed > maximum_velocity) {
      return change_speed(maximum_velocity, direction);
    }
    if (speed == maximum_velocity) {
      return {(length - braking) / speed, 0.0L, velocity_};
    }
    const long double a = acceleration;
    const long double d = deceleration;
    const long double peak = std::sqrt((2.0L * a * d * length + d * speed * speed) / (a + d));
    return change_speed(std::min(peak, maximum_velocity), direction);
  }

  bool positioning_ = true;
  long double target_ = 0.0L;
  long double position_ = 0.0L;
  long double velocity_ = 0.0L;
};

}  // namespace stator::control::tests
