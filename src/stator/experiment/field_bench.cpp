#include "stator/experiment/field_bench.hpp"

#include <cmath>
#include <limits>

namespace stator::experiment {

plant::StepperAxisParameters uncoupled(plant::StepperAxisParameters axis) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  axis.load.end_stop_minimum = -kInfinity;
  axis.load.end_stop_maximum = kInfinity;
  axis.load.unbalance_torque = 0.0;
  axis.load.brake_torque = 0.0;
  axis.initial_revolutions = 0.0;
  axis.supply = {};
  axis.motor.temperature_coefficient = 0.0;
  axis.left_switch = {};
  axis.right_switch = {};
  axis.home_switch = {};
  return axis;
}

void FieldBench::turn() {
  field_ = plant::turned(field_, speed_ * step() * plant_.parameters().motor.pole_pairs);
  drive();
}

void FieldBench::lead() {
  const plant::HybridStepperState& motor = plant_.state().motor;
  const double ahead = motor.speed * step() * plant_.parameters().motor.pole_pairs;
  field_ = plant::turned(motor.angle, 0.5 * base::kPi + ahead);
  drive();
}

void FieldBench::hold(double angle) {
  field_ = plant::turned({}, angle);
  drive();
}

void FieldBench::release() {
  plant_.step({.bridge_enabled = false}, step_);
}

void FieldBench::build_up_current() {
  constexpr double kTimeConstants = 20.0;
  const plant::StepperMotorParameters& motor = plant_.parameters().motor;
  const double time = kTimeConstants * motor.inductance / motor.resistance;
  field_ = plant::turned(plant_.state().motor.angle, 0.5 * base::kPi);
  const auto steps = static_cast<int>(std::ceil(time / step()));
  for (int n = 0; n < steps; ++n) {
    drive(false);
  }
}

void FieldBench::spin(double speed) {
  plant::StepperAxisState state = plant_.state();
  state.motor.speed = speed;
  plant_.restore(state);
}

void FieldBench::drive(bool brake_released) {
  const base::SineCosine direction = base::sine_cosine(field_.angle);
  plant_.step({.bridge_enabled = true,
               .coil_current_target = {amplitude_ * direction.cosine, amplitude_ * direction.sine},
               .brake_released = brake_released},
              step_);
}

double FieldBench::lag() const {
  const plant::ElectricalAngle& rotor = plant_.state().motor.angle;
  return static_cast<double>(field_.periods - rotor.periods) * base::kTwoPi +
         (field_.angle - rotor.angle);
}

void FieldBench::restore(const Snapshot& snapshot) {
  plant_.restore(snapshot.plant);
  field_ = snapshot.field;
  speed_ = snapshot.speed;
}

}  // namespace stator::experiment
