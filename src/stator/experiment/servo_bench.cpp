#include "stator/experiment/servo_bench.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace stator::experiment {

namespace {

constexpr double kInverseSquareRootOfThree = 0.57735026918962576451;

}  // namespace

plant::ServoAxisParameters uncoupled(plant::ServoAxisParameters axis) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  axis.load.end_stop_minimum = -kInfinity;
  axis.load.end_stop_maximum = kInfinity;
  axis.load.unbalance_torque = 0.0;
  axis.load.brake_torque = 0.0;
  axis.initial_revolutions = 0.0;
  axis.supply.capacitance = 0.0;
  axis.motor.resistance_coefficient = 0.0;
  axis.motor.flux_coefficient = 0.0;
  axis.left_switch = {};
  axis.right_switch = {};
  axis.home_switch = {};
  return axis;
}

double CommutatorBench::longest_vector(double supply) {
  return supply * kInverseSquareRootOfThree;
}

void CommutatorBench::drive(double direct, double quadrature, bool brake_chopper_on) {
  const plant::SynchronousMotorState& motor = plant_.state().motor;
  const double ahead = 0.5 * step() * motor.speed * plant_.parameters().motor.pole_pairs;
  const base::SineCosine z = base::sine_cosine(motor.angle.angle + ahead);
  const std::array<double, 3> phase = plant::phase_values(
      {z.cosine * direct - z.sine * quadrature, z.sine * direct + z.cosine * quadrature});
  // Highest and lowest phase equally far from the ends of the supply: space-vector modulation.
  const auto [low, high] = std::minmax({phase[0], phase[1], phase[2]});
  const double middle = 0.5 * (low + high);
  base::ServoActuation actuation{.bridge_enabled = true, .brake_chopper_on = brake_chopper_on};
  for (std::size_t k = 0; k < 3; ++k) {
    actuation.duty[k] = 0.5 + (phase[k] - middle) / plant_.sensing().supply_voltage;
  }
  plant_.step(actuation, step_);
}

void CommutatorBench::regulate(double quadrature_current, bool brake_chopper_on) {
  const plant::ThreePhaseMotorParameters& motor = plant_.parameters().motor;
  const plant::ServoAxisObservation seen = plant_.observe();
  const double electrical = seen.speed * motor.pole_pairs;
  const double resistance = motor.resistance + plant_.parameters().inverter.on_resistance;
  // Half of the error goes in each step.
  const double gain = 0.5 / step();
  const double direct = -electrical * motor.quadrature_inductance * quadrature_current -
                        motor.direct_inductance * gain * seen.direct_current;
  const double quadrature =
      resistance * quadrature_current + electrical * motor.flux_linkage +
      motor.quadrature_inductance * gain * (quadrature_current - seen.quadrature_current);
  drive(direct, quadrature, brake_chopper_on);
}

void CommutatorBench::release() {
  plant_.step({.bridge_enabled = false}, step_);
}

void CommutatorBench::spin(double speed) {
  plant::ServoAxisState state = plant_.state();
  state.motor.speed = speed;
  plant_.restore(state);
}

}  // namespace stator::experiment
