#include "plant/stepper_axis.hpp"

#include <algorithm>
#include <cmath>

namespace stator::plant {

namespace {

/// Inner steps turn the fastest motion of the model by no more than this, rad.
constexpr double kLargestTurn = 0.33;

}  // namespace

StepperAxis::StepperAxis(const StepperAxisParameters& parameters)
    : parameters_(parameters),
      motor_(parameters.motor, parameters.load),
      encoder_(parameters.encoder, parameters.motor.pole_pairs) {
  state_.motor.angle = motor_.angle_at(parameters.initial_revolutions);
  state_.encoder = encoder_.power_on(state_.motor.angle);
  state_.supply_voltage = parameters.supply_voltage;
}

base::AxisSensing StepperAxis::step(const base::AxisActuation& actuation,
                                    base::SimDuration duration) {
  if (settled_ && actuation == settled_actuation_ && duration == settled_duration_) {
    return settled_sensing_;
  }
  const HybridStepperState before = state_.motor;
  double remaining = duration.seconds();
  while (remaining > 0.0) {
    const double turn = remaining * motor_.fastest_rate(state_.motor);
    const double inner =
        turn <= kLargestTurn ? remaining : remaining / std::ceil(turn / kLargestTurn);
    regulate_and_integrate(actuation, inner);
    encoder_.update(state_.encoder, state_.motor.angle);
    remaining = inner == remaining ? 0.0 : remaining - inner;
  }
  settled_ = state_.motor == before;
  if (settled_) {
    settled_actuation_ = actuation;
    settled_duration_ = duration;
    settled_sensing_ = sense();
    return settled_sensing_;
  }
  return sense();
}

void StepperAxis::regulate_and_integrate(const base::AxisActuation& actuation, double step) {
  HybridStepperState& motor = state_.motor;
  const double supply = state_.supply_voltage;
  const double half_resistance = 0.5 * parameters_.motor.resistance;
  if (step != regulated_step_) {
    regulated_step_ = step;
    current_gain_ = parameters_.motor.inductance / step;
  }
  const base::SineCosine direction = base::sine_cosine(motor.angle.angle);
  // Induced voltage half a step ahead, to first order in the angle travelled.
  const double ahead = 0.5 * step * motor.speed * parameters_.motor.pole_pairs;
  const std::array<double, 2> induced = motor_.induced_voltage(
      {direction.sine + ahead * direction.cosine, direction.cosine - ahead * direction.sine},
      motor.speed);

  HybridStepperInput input;
  input.torque = state_.external_torque;
  input.brake_engaged = !actuation.brake_released;
  std::array<bool, 2> runs_dry{};
  for (std::size_t k = 0; k < 2; ++k) {
    const double target = actuation.bridge_enabled ? actuation.coil_current_target[k] : 0.0;
    const double needed = half_resistance * (motor.current[k] + target) +
                          current_gain_ * (target - motor.current[k]) + induced[k];
    const bool reachable = std::fabs(needed) <= supply;
    input.voltage[k] = std::clamp(needed, -supply, supply);
    // A disabled bridge is a rectifier: no current flows while the diodes block.
    input.open[k] = !actuation.bridge_enabled && motor.current[k] == 0.0 && reachable;
    runs_dry[k] = !actuation.bridge_enabled && reachable;
  }
  motor_.step(motor, direction, input, step);
  for (std::size_t k = 0; k < 2; ++k) {
    if (runs_dry[k]) {
      motor.current[k] = 0.0;
    }
  }
}

base::AxisSensing StepperAxis::sense() const {
  const double revolutions = motor_.revolutions(state_.motor);
  base::AxisSensing sensing;
  sensing.coil_current = state_.motor.current;
  sensing.encoder_count = encoder_.count(state_.encoder);
  sensing.encoder_index = encoder_.index(state_.encoder);
  sensing.encoder_index_passages = state_.encoder.index_passages;
  sensing.encoder_index_count = encoder_.index_count(state_.encoder);
  sensing.left_switch = parameters_.left_switch.level(revolutions);
  sensing.right_switch = parameters_.right_switch.level(revolutions);
  sensing.home_switch = parameters_.home_switch.level(revolutions);
  sensing.supply_voltage = state_.supply_voltage;
  return sensing;
}

StepperAxisObservation StepperAxis::observe() const {
  StepperAxisObservation seen;
  seen.shaft_revolutions = motor_.revolutions(state_.motor);
  seen.shaft_angle = seen.shaft_revolutions * base::kTwoPi;
  seen.speed = state_.motor.speed;
  seen.electromagnetic_torque = motor_.electromagnetic_torque(state_.motor);
  seen.load_angle = motor_.load_angle(state_.motor);
  seen.load_torque = motor_.load_torque(state_.motor, state_.external_torque);
  seen.coil_current = state_.motor.current;
  return seen;
}

}  // namespace stator::plant
