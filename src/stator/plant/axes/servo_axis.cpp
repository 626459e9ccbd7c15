#include "stator/plant/axes/servo_axis.hpp"

#include <algorithm>
#include <cmath>

namespace stator::plant {

namespace {

/// Inner steps turn the fastest motion of the model by no more than this, rad.
constexpr double kLargestTurn = 0.33;

/// The fastest time constant of the thermal models is near a second.
constexpr base::SimDuration kThermalPeriod{10'000'000};

double square(const StatorVector& vector) {
  return vector.alpha * vector.alpha + vector.beta * vector.beta;
}

}  // namespace

ServoAxis::ServoAxis(const ServoAxisParameters& parameters)
    : parameters_(parameters),
      motor_(parameters.motor, parameters.load),
      encoder_(parameters.encoder, parameters.motor.pole_pairs),
      halls_(parameters.halls),
      current_sensing_(parameters.current_sensing),
      supply_(parameters.supply),
      motor_thermal_(parameters.motor.thermal, kThermalPeriod.seconds()),
      stage_thermal_(parameters.inverter.thermal, kThermalPeriod.seconds()),
      has_switches_(parameters.left_switch.fitted || parameters.right_switch.fitted ||
                    parameters.home_switch.fitted) {
  ServoAxisState state;
  state.motor = motor_.at(parameters.initial_revolutions);
  state.encoder = encoder_.power_on(state.motor.angle);
  state.halls = halls_.power_on(state.motor.direction);
  state.brake.open = parameters.brake.closed_by_current;
  state.supply = {.source = parameters.supply_voltage, .voltage = parameters.supply_voltage};
  state.fault_state.supply_voltage = parameters.supply_voltage;
  const double ambient = parameters.ambient_temperature;
  state.ambient_temperature = ambient;
  state.motor_temperature = {ambient, ambient};
  state.stage_temperature = {ambient, ambient};
  state.noise = base::Random(parameters.noise_seed);
  restore(state);
}

const base::ServoSensing& ServoAxis::step(const base::ServoActuation& actuation,
                                          base::SimDuration duration) {
  state_.unheated += duration;
  if (settled_ && actuation == settled_actuation_ && duration == settled_duration_) {
    if (state_.unheated >= kThermalPeriod) {
      update_temperatures();
    }
    if (current_sensing_.noisy()) {
      sense_currents();
    }
    return sensing_;
  }
  settled_ = false;
  if (state_.motor.speed == 0.0) [[unlikely]] {
    step_and_settle(actuation, duration);
  } else {
    pass(actuation, duration);
  }
  return sensing_;
}

std::int64_t ServoAxis::restful_steps() const {
  if (!settled_ || current_sensing_.noisy()) {
    return 0;
  }
  constexpr base::SimDuration kInstant{1};
  return std::max((kThermalPeriod - kInstant - state_.unheated) / settled_duration_,
                  std::int64_t{0});
}

void ServoAxis::step_and_settle(const base::ServoActuation& actuation, base::SimDuration duration) {
  const SynchronousMotorState motor_before = state_.motor;
  const SupplyState supply_before = state_.supply;
  const std::uint8_t halls_before = state_.halls;
  pass(actuation, duration);
  if (state_.motor == motor_before && state_.supply == supply_before &&
      state_.halls == halls_before && state_.brake.open == actuation.brake_released &&
      state_.faults.common.encoders[0].noise < 1.0) {
    settled_ = true;
    settled_actuation_ = actuation;
    settled_duration_ = duration;
  }
}

void ServoAxis::pass(const base::ServoActuation& actuation, base::SimDuration duration) {
  parameters_.brake.advance(state_.brake, actuation.brake_released, duration);
  const double step = duration.seconds();
  if (plain_ && actuation.bridge_enabled && state_.motor.speed != 0.0 &&
      step * motor_.fastest_rate(state_.motor, step) <= kLargestTurn) [[likely]] {
    turn(actuation, step);
    sense_angle();
  } else {
    pass_in_parts(actuation, step);
  }
  if (state_.unheated >= kThermalPeriod) [[unlikely]] {
    update_temperatures();
  }
  sense();
  if (faulty_ && actuation.bridge_enabled) [[unlikely]] {
    sensing_.overcurrent = state_.faults.shorted;
    sensing_.overcurrent_high_side = state_.faults.high_side;
  }
}

void ServoAxis::pass_in_parts(const base::ServoActuation& actuation, double duration) {
  double remaining = duration;
  while (remaining > 0.0) {
    const double turn = remaining * motor_.fastest_rate(state_.motor, remaining);
    const double inner =
        turn <= kLargestTurn ? remaining : remaining / std::ceil(turn / kLargestTurn);
    if (actuation.bridge_enabled) {
      drive(actuation, inner);
    } else {
      rectify(actuation.brake_chopper_on, inner);
    }
    sense_angle();
    remaining = inner == remaining ? 0.0 : remaining - inner;
  }
}

SynchronousMotorInput ServoAxis::motor_input() const {
  SynchronousMotorInput input;
  input.torque = state_.external_torque;
  input.brake_engaged = !state_.brake.open;
  return input;
}

void ServoAxis::turn(const base::ServoActuation& actuation, double step) {
  SynchronousMotorInput input = motor_input();
  input.series_resistance = parameters_.inverter.on_resistance;
  const StatorVector share =
      stator_vector(within_period(actuation.duty[0]), within_period(actuation.duty[1]),
                    within_period(actuation.duty[2]));
  const double supply = state_.supply.voltage;
  input.voltage = {supply * share.alpha, supply * share.beta};
  account(motor_.turn(state_.motor, input, step), step, actuation.brake_chopper_on);
}

void ServoAxis::account(double power, double step, bool chopper_on) {
  state_.supply_power = power;
  state_.supplied_energy += power * step;
  supply_.draw(state_.supply, power, step, chopper_on);
  state_.square_current += step * square(state_.motor.current);
  state_.heated_time += step;
}

void ServoAxis::update_temperatures() {
  const SynchronousMotorState& motor = state_.motor;
  const double elapsed = state_.unheated.seconds();
  // Settled steps were not summed up; the current had its present value in all of them.
  const double settled = std::max(0.0, elapsed - state_.heated_time);
  const double mean_square = (state_.square_current + settled * square(motor.current)) / elapsed;
  const InverterParameters& inverter = parameters_.inverter;
  const double phases = 1.5 * mean_square;  // A^2, sum of the squares of the three
  const HeatFaults& heat = state_.faults.common.heat;
  const double stage_loss = inverter.on_resistance * phases +
                            inverter.switching_share * state_.supply.voltage * std::sqrt(phases) +
                            heat.driver_heat;
  const double motor_loss = motor_.resistance() * phases + heat.motor_heat;
  for (; state_.unheated >= kThermalPeriod; state_.unheated = state_.unheated - kThermalPeriod) {
    motor_thermal_.advance(state_.motor_temperature, motor_loss, state_.ambient_temperature);
    stage_thermal_.advance(state_.stage_temperature, stage_loss, state_.ambient_temperature);
  }
  state_.square_current = 0.0;
  state_.heated_time = 0.0;
  motor_.set_temperatures(state_.motor_temperature.inner, state_.motor_temperature.outer);
  sensing_.driver_temperature = state_.stage_temperature.inner + heat.driver_reading;
  // Without current resistance and flux are of no consequence: a motor that cools down stays
  // settled.
  if (mean_square > 0.0) {
    settled_ = false;
  }
  if (motor.speed != 0.0) {
    SynchronousMotor::refresh_direction(state_.motor);
  }
}

void ServoAxis::set_external_torque(double torque) {
  state_.external_torque = torque;
  settled_ = false;
}

void ServoAxis::sense_angle() {
  encoder_.update(state_.encoder, state_.motor.angle);
  state_.halls = halls_.next(state_.halls, state_.motor.direction);
}

void ServoAxis::sense() {
  sense_currents();
  sense_encoder();
  sensing_.halls = hall_signal();
  if (has_switches_) {
    sense_switches();
  }
  sensing_.supply_voltage = state_.supply.voltage;
  sensing_.overcurrent = {};
  sensing_.overcurrent_high_side = false;
}

void ServoAxis::sense_currents() {
  const std::array<double, 3> current = phase_values(state_.motor.current);
  sensing_.phase_current =
      current_sensing_.exact() ? current : current_sensing_.measure(current, state_.noise);
}

void ServoAxis::sense_encoder() {
  if (spoiled_) [[unlikely]] {
    spoil_encoder();
  }
  sensing_.encoder_count = encoder_.count(state_.encoder);
  sensing_.encoder_index_passages = state_.encoder.index_passages;
  sensing_.encoder_index_count = encoder_.index_count(state_.encoder);
  sensing_.encoder_index = encoder_.index(state_.encoder);
  if (spoiled_) [[unlikely]] {
    spoil_encoder_reading();
  }
}

std::uint8_t ServoAxis::hall_signal() const {
  const std::uint8_t signal = halls_.signal(state_.halls);
  if (!faulty_) [[likely]] {
    return signal;
  }
  return through_cable(signal, state_.faults.halls_swapped, state_.faults.halls);
}

}  // namespace stator::plant
