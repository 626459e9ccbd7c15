#pragma once

#include "stator/base/trigonometry.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::plant {

/// Drives an axis as an ideal sequencer would: a current vector of constant amplitude whose angle
/// follows a commanded speed, in steps of 50 us.
class RotatingField {
 public:
  static constexpr base::SimDuration kStep{50'000};

  RotatingField(StepperAxis& axis, double amplitude) : axis_(axis), amplitude_(amplitude) {}

  /// Runs for `seconds` while the field's speed changes by `acceleration` (shaft rad/s^2).
  void run(double seconds, double acceleration = 0.0) {
    const auto steps = static_cast<int>(seconds / kStep.seconds() + 0.5);
    for (int i = 0; i < steps; ++i) {
      step(acceleration);
    }
  }

  void step(double acceleration = 0.0) {
    speed_ += acceleration * kStep.seconds();
    angle_ = turned(angle_, speed_ * kStep.seconds() * axis_.parameters().motor.pole_pairs);
    const base::SineCosine direction = base::sine_cosine(angle_.angle);
    actuation_.coil_current_target = {amplitude_ * direction.cosine, amplitude_ * direction.sine};
    sensing_ = axis_.step(actuation_, kStep);
  }

  void stop() { speed_ = 0.0; }

  /// Field ahead of the rotor in electrical radians, counting whole periods.
  [[nodiscard]] double lag() const {
    const ElectricalAngle& rotor = axis_.state().motor.angle;
    return static_cast<double>(angle_.periods - rotor.periods) * base::kTwoPi +
           (angle_.angle - rotor.angle);
  }
  [[nodiscard]] double speed() const { return speed_; }
  /// Of the latest step.
  [[nodiscard]] const base::AxisActuation& actuation() const { return actuation_; }
  [[nodiscard]] const base::AxisSensing& sensing() const { return sensing_; }

  /// Raises an opposing torque by `rate` (N m/s) from 0 until the rotor falls out of step;
  /// returns the torque (N m) on the shaft at that moment.
  double pull_out(double rate) {
    double torque = 0.0;
    while (lag() < base::kTwoPi && torque < 100.0) {
      torque += rate * kStep.seconds();
      axis_.set_external_torque(-torque);
      step();
    }
    return torque;
  }

 private:
  StepperAxis& axis_;
  double amplitude_;    ///< A
  double speed_ = 0.0;  ///< rad/s of the shaft
  ElectricalAngle angle_;
  base::AxisActuation actuation_{.bridge_enabled = true};
  base::AxisSensing sensing_;
};

}  // namespace stator::plant
