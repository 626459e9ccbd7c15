#include "stator/plant/axes/stepper_axis.hpp"

#include <algorithm>
#include <cmath>

namespace stator::plant {

namespace {

/// Inner steps turn the fastest motion of the model by no more than this, rad.
constexpr double kLargestTurn = 0.33;

/// rad/s at which any rotor of this kind has burst: nothing turns faster, whatever drives it.
constexpr double kBurstingSpeed = 1e4;

/// The fastest time constant of the thermal models is near a second.
constexpr base::SimDuration kThermalPeriod{1'000'000};

}  // namespace

StepperAxis::StepperAxis(const StepperAxisParameters& parameters)
    : parameters_(parameters),
      motor_(parameters.motor, parameters.load),
      encoder_(parameters.encoder, parameters.motor.pole_pairs),
      supply_(parameters.supply),
      motor_thermal_(parameters.motor.thermal, kThermalPeriod.seconds()),
      driver_thermal_(parameters.driver.thermal, kThermalPeriod.seconds()),
      electrical_per_torque_(parameters.motor.pole_pairs / motor_.inertia()),
      has_switches_(parameters.left_switch.fitted || parameters.right_switch.fitted ||
                    parameters.home_switch.fitted) {
  state_.motor.angle = motor_.angle_at(parameters.initial_revolutions);
  state_.encoder = encoder_.power_on(state_.motor.angle);
  state_.brake.open = parameters.brake.closed_by_current;
  state_.supply = {.source = parameters.supply_voltage, .voltage = parameters.supply_voltage};
  state_.fault_state.supply_voltage = parameters.supply_voltage;
  const double ambient = parameters.ambient_temperature;
  state_.ambient_temperature = ambient;
  state_.motor_temperature = {ambient, ambient};
  state_.driver_temperature = {ambient, ambient};
  follow_winding_temperature();
  sense_into(sensing_);
}

const base::AxisSensing& StepperAxis::step(const base::AxisActuation& actuation,
                                           base::SimDuration duration) {
  state_.unheated += duration;
  if (settled_ && actuation == settled_actuation_ && duration == settled_duration_) {
    if (state_.unheated >= kThermalPeriod) {
      update_temperatures();
      sensing_.driver_temperature =
          state_.driver_temperature.inner + state_.faults.common.heat.driver_reading;
    }
    return sensing_;
  }
  const HybridStepperState before = state_.motor;
  parameters_.brake.advance(state_.brake, actuation.brake_released, duration);
  const SupplyState supply_before = state_.supply;
  const double whole = duration.seconds();
  double remaining = whole;
  while (remaining > 0.0) {
    double turn = remaining * motor_.fastest_rate(state_.motor);
    // A torque from outside that no motor of this size would make may spin the shaft up within the
    // step.
    if (const double spin = outside_acceleration() * remaining * remaining; spin > kLargestTurn)
        [[unlikely]] {
      turn += spin;
    }
    const double inner =
        turn <= kLargestTurn ? remaining : remaining / std::ceil(turn / kLargestTurn);
    if (inner == remaining) [[likely]] {
      regulate_and_integrate(actuation, inner);
    } else {
      regulate_and_integrate(on_the_way(actuation, (remaining - inner) / whole), inner);
    }
    state_.motor.speed = std::clamp(state_.motor.speed, -kBurstingSpeed, kBurstingSpeed);
    encoder_.update(state_.encoder, state_.motor.angle);
    remaining = inner == remaining ? 0.0 : remaining - inner;
  }
  state_.coil_current_target =
      actuation.bridge_enabled ? actuation.coil_current_target : std::array<double, 2>{};
  settled_ = state_.motor == before && state_.supply == supply_before &&
             state_.brake.open == actuation.brake_released;
  if (state_.unheated >= kThermalPeriod) {
    update_temperatures();
  }
  if (spoiled_) [[unlikely]] {
    spoil_encoder();
  }
  sense_into(sensing_);
  if (spoiled_) [[unlikely]] {
    spoil_sensors();
  }
  if (faulty_ && actuation.bridge_enabled) [[unlikely]] {
    sensing_.overcurrent = state_.faults.shorted;
    sensing_.overcurrent_high_side = state_.faults.high_side;
  }
  if (settled_) {
    settled_actuation_ = actuation;
    settled_duration_ = duration;
  }
  return sensing_;
}

base::AxisActuation StepperAxis::on_the_way(const base::AxisActuation& actuation,
                                            double left) const {
  base::AxisActuation part_way = actuation;
  for (std::size_t k = 0; k < 2; ++k) {
    part_way.coil_current_target[k] -=
        left * (actuation.coil_current_target[k] - state_.coil_current_target[k]);
  }
  return part_way;
}

HybridStepperInput StepperAxis::phase_input(const base::AxisActuation& actuation,
                                            const std::array<double, 2>& induced, double step,
                                            std::array<bool, 2>& runs_dry) {
  const std::array<double, 2>& current = state_.motor.current;
  const double supply = state_.supply.voltage;
  const double half_resistance = 0.5 * resistance();
  if (step != regulated_step_) {
    regulated_step_ = step;
    current_gain_ = parameters_.motor.inductance / step;
  }
  HybridStepperInput input;
  input.torque = state_.external_torque;
  input.brake_engaged = !state_.brake.open;
  state_.chopper.regulated = true;
  for (std::size_t k = 0; k < 2; ++k) {
    const double target = actuation.bridge_enabled ? actuation.coil_current_target[k] : 0.0;
    const double needed = half_resistance * (current[k] + target) +
                          current_gain_ * (target - current[k]) + induced[k];
    const bool reachable = std::fabs(needed) <= supply;
    input.voltage[k] = std::clamp(needed, -supply, supply);
    // A disabled bridge is a rectifier: no current flows while the diodes block.
    input.open[k] = !actuation.bridge_enabled && current[k] == 0.0 && reachable;
    runs_dry[k] = !actuation.bridge_enabled && reachable;
    state_.chopper.regulated = state_.chopper.regulated && reachable;
    if (actuation.bridge_enabled && actuation.voltage_mode) {
      input.voltage[k] = supply * std::clamp(actuation.coil_duty[k], -1.0, 1.0);
    }
  }
  return input;
}

void StepperAxis::regulate_and_integrate(const base::AxisActuation& actuation, double step) {
  HybridStepperState& motor = state_.motor;
  const base::SineCosine direction = base::sine_cosine(motor.angle.angle);
  // Induced voltage half a step ahead, to first order in the angle travelled.
  const double ahead = 0.5 * step * motor.speed * parameters_.motor.pole_pairs;
  const std::array<double, 2> induced = motor_.induced_voltage(
      {direction.sine + ahead * direction.cosine, direction.cosine - ahead * direction.sine},
      motor.speed);
  const std::array<double, 2> current_before = motor.current;

  std::array<bool, 2> runs_dry{};
  HybridStepperInput input = phase_input(actuation, induced, step, runs_dry);
  if (faulty_) [[unlikely]] {
    for (std::size_t k = 0; k < 2; ++k) {
      if (state_.faults.open[k]) {
        motor.current[k] = 0.0;
        input.open[k] = true;
      } else if (actuation.bridge_enabled &&
                 (state_.faults.shorted[k] || state_.faults.high_side)) {
        input.voltage[k] = 0.0;  // the coil's ends lie on the same potential
      }
    }
  }
  motor_.step(motor, direction, input, step);
  for (std::size_t k = 0; k < 2; ++k) {
    if (runs_dry[k]) {
      motor.current[k] = 0.0;
    }
  }
  observe_chopper(induced, current_before, input, step);
}

void StepperAxis::observe_chopper(const std::array<double, 2>& induced,
                                  const std::array<double, 2>& current_before,
                                  const HybridStepperInput& input, double step) {
  const HybridStepperState& motor = state_.motor;
  const double a = 0.5 * (current_before[0] + motor.current[0]);
  const double b = 0.5 * (current_before[1] + motor.current[1]);
  state_.chopper.induced_voltage = motor_.torque_constant() * motor.speed;
  state_.chopper.converted_power = induced[0] * a + induced[1] * b;
  state_.square_current += step * (a * a + b * b);
  state_.heated_time += step;
  if (!supply_.ideal()) {
    supply_.draw(state_.supply, input.voltage[0] * a + input.voltage[1] * b, step, false);
  }
}

void StepperAxis::update_temperatures() {
  const double elapsed = state_.unheated.seconds();
  const std::array<double, 2>& i = state_.motor.current;
  // Settled steps were not summed up; the current had its present value in all of them.
  const double settled = std::max(0.0, elapsed - state_.heated_time);
  const double mean_square =
      (state_.square_current + settled * (i[0] * i[0] + i[1] * i[1])) / elapsed;
  const DriverStageParameters& driver = parameters_.driver;
  const HeatFaults& heat = state_.faults.common.heat;
  const double stage_loss =
      driver.on_resistance * mean_square +
      driver.switching_share * state_.supply.voltage * std::sqrt(mean_square) + heat.driver_heat;
  const double motor_loss = resistance() * mean_square + heat.motor_heat;
  for (; state_.unheated >= kThermalPeriod; state_.unheated = state_.unheated - kThermalPeriod) {
    motor_thermal_.advance(state_.motor_temperature, motor_loss, state_.ambient_temperature);
    driver_thermal_.advance(state_.driver_temperature, stage_loss, state_.ambient_temperature);
  }
  state_.square_current = 0.0;
  state_.heated_time = 0.0;
  const double before = resistance();
  follow_winding_temperature();
  // Without current the resistance is of no consequence: a motor that cools down stays settled.
  if (mean_square > 0.0 && resistance() != before) {
    settled_ = false;
  }
}

void StepperAxis::follow_winding_temperature() {
  constexpr double kSheetTemperature = 25.0;
  const StepperMotorParameters& motor = parameters_.motor;
  motor_.set_resistance(
      motor.resistance *
      (1.0 + motor.temperature_coefficient * (state_.motor_temperature.inner - kSheetTemperature)));
}

base::AxisSensing StepperAxis::sense() const {
  base::AxisSensing sensing;
  sense_into(sensing);
  return sensing;
}

void StepperAxis::sense_into(base::AxisSensing& sensing) const {
  const double revolutions = has_switches_ ? motor_.revolutions(state_.motor) : 0.0;
  sensing.coil_current = state_.motor.current;
  sensing.encoder_count = encoder_.count(state_.encoder);
  sensing.encoder_index = encoder_.index(state_.encoder);
  sensing.encoder_index_passages = state_.encoder.index_passages;
  sensing.encoder_index_count = encoder_.index_count(state_.encoder);
  sensing.left_switch = parameters_.left_switch.level(revolutions, state_.left_by_hand);
  sensing.right_switch = parameters_.right_switch.level(revolutions, state_.right_by_hand);
  sensing.home_switch = parameters_.home_switch.level(revolutions, state_.home_by_hand);
  sensing.supply_voltage = state_.supply.voltage;
  sensing.driver_temperature = state_.driver_temperature.inner;
  sensing.induced_voltage = state_.chopper.induced_voltage;
  sensing.converted_power = state_.chopper.converted_power;
  sensing.current_regulated = state_.chopper.regulated;
  sensing.overcurrent = {};
  sensing.overcurrent_high_side = false;
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
  seen.winding_temperature = state_.motor_temperature.inner;
  seen.housing_temperature = state_.motor_temperature.outer;
  seen.driver_temperature = state_.driver_temperature.inner;
  return seen;
}

}  // namespace stator::plant
