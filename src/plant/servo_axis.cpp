#include "plant/servo_axis.hpp"

#include <algorithm>
#include <cmath>

#include "plant/diode_bridge.hpp"

namespace stator::plant {

namespace {

/// Inner steps turn the fastest motion of the model by no more than this, rad.
constexpr double kLargestTurn = 0.33;

/// The fastest time constant of the thermal models is near a second.
constexpr base::SimDuration kThermalPeriod{1'000'000};

/// s, the longest step in which diodes carry current: they close and open at its ends only.
constexpr double kDiodeStep = 5e-6;

/// V at which a bridge that still wants power gets what the capacitor can give, not an infinite
/// current.
constexpr double kLowestVoltage = 1.0;

double square(const StatorVector& vector) {
  return vector.alpha * vector.alpha + vector.beta * vector.beta;
}

WindingConnection connection_of(const std::array<bool, 3>& open) {
  switch (static_cast<int>(open[0]) + 2 * static_cast<int>(open[1]) +
          4 * static_cast<int>(open[2])) {
    case 0:
      return WindingConnection::all;
    case 1:
      return WindingConnection::without_u;
    case 2:
      return WindingConnection::without_v;
    case 4:
      return WindingConnection::without_w;
    default:
      return WindingConnection::none;
  }
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
  const double ambient = parameters.ambient_temperature;
  state.ambient_temperature = ambient;
  state.motor_temperature = {ambient, ambient};
  state.stage_temperature = {ambient, ambient};
  state.noise = base::Random(parameters.noise_seed);
  restore(state);
}

void ServoAxis::restore(const ServoAxisState& state) {
  state_ = state;
  faulty_ = state.faults != ServoAxisFaults{};
  motor_.set_temperatures(state.motor_temperature.inner, state.motor_temperature.outer);
  settled_ = false;
  sensing_ = {};
  sensing_.encoder_count = encoder_.count(state.encoder) - state.lost_counts;
  sensing_.encoder_index_passages = state.encoder.index_passages - state.lost_passages;
  sensing_.driver_temperature = state.stage_temperature.inner;
  sense_switches();
  sense();
  state_.noise = state.noise;  // the next sample is the one that follows the snapshot
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
      state_.halls == halls_before && state_.brake.open == actuation.brake_released) {
    settled_ = true;
    settled_actuation_ = actuation;
    settled_duration_ = duration;
  }
}

void ServoAxis::pass(const base::ServoActuation& actuation, base::SimDuration duration) {
  parameters_.brake.advance(state_.brake, actuation.brake_released, duration);
  double remaining = duration.seconds();
  while (remaining > 0.0) {
    const double turn = remaining * motor_.fastest_rate(state_.motor, remaining);
    const double inner =
        turn <= kLargestTurn ? remaining : remaining / std::ceil(turn / kLargestTurn);
    if (actuation.bridge_enabled) [[likely]] {
      drive(actuation, inner);
    } else {
      rectify(actuation.brake_chopper_on, inner);
    }
    encoder_.update(state_.encoder, state_.motor.angle);
    state_.halls = halls_.next(state_.halls, state_.motor.direction);
    remaining = inner == remaining ? 0.0 : remaining - inner;
  }
  if (state_.unheated >= kThermalPeriod) {
    update_temperatures();
  }
  sense();
  if (faulty_ && actuation.bridge_enabled) [[unlikely]] {
    sensing_.overcurrent = state_.faults.shorted;
    sensing_.overcurrent_high_side = state_.faults.high_side;
  }
}

SynchronousMotorInput ServoAxis::motor_input() const {
  SynchronousMotorInput input;
  input.torque = state_.external_torque;
  input.brake_engaged = !state_.brake.open;
  return input;
}

void ServoAxis::drive(const base::ServoActuation& actuation, double step) {
  const InverterParameters& inverter = parameters_.inverter;
  std::array<double, 3> duty{};
  for (std::size_t k = 0; k < 3; ++k) {
    duty[k] = std::clamp(actuation.duty[k], 0.0, 1.0);
  }
  SynchronousMotorInput input = motor_input();
  input.series_resistance = inverter.on_resistance;
  if (faulty_) [[unlikely]] {
    for (std::size_t k = 0; k < 3; ++k) {
      duty[k] = state_.faults.shorted[k] || state_.faults.high_side ? 0.0 : duty[k];
    }
    input.connection = connection_of(state_.faults.open);
  }
  const double supply = state_.supply.voltage;
  const StatorVector share = stator_vector(duty[0], duty[1], duty[2]);
  input.voltage = {supply * share.alpha, supply * share.beta};
  double lost_power = 0.0;
  if (inverter.dead_time > 0.0) {
    const StatorVector drop = dead_time_drop(state_.motor.current, step, lost_power);
    input.voltage.alpha -= drop.alpha;
    input.voltage.beta -= drop.beta;
  }
  const double power = motor_.step(state_.motor, input, step) + lost_power;
  account(power, step, actuation.brake_chopper_on);
}

StatorVector ServoAxis::dead_time_drop(const StatorVector& current, double step,
                                       double& lost_power) const {
  const InverterParameters& inverter = parameters_.inverter;
  const double supply = state_.supply.voltage;
  const double share = inverter.dead_time * inverter.pwm_frequency;
  const double by_diodes = 2.0 * share * inverter.diode_drop;
  const double drop = supply * share + by_diodes;
  // Within the ripple (Vb T / 8 L either way) the current changes its sign each period and the drop
  // cancels. An explicit step bears no more than this resistance, drop / ripple.
  const double inductance = parameters_.motor.direct_inductance;
  const double ripple = std::max(supply / (8.0 * inductance * inverter.pwm_frequency),
                                 4.0 * drop * step / inductance);
  std::array<double, 3> voltage = phase_values(current);
  for (double& phase : voltage) {
    lost_power += by_diodes * std::fabs(phase);
    phase = drop * std::clamp(phase / ripple, -1.0, 1.0);
  }
  return stator_vector(voltage[0], voltage[1], voltage[2]);
}

void ServoAxis::rectify(bool chopper_on, double step) {
  SynchronousMotorInput input = motor_input();
  SynchronousMotorState& motor = state_.motor;
  const double drop = parameters_.inverter.diode_drop;
  const bool currentless = motor.current == StatorVector{};
  if (currentless && !faulty_ &&
      motor_.largest_line_to_line_emf(motor) < state_.supply.voltage + 2.0 * drop) [[likely]] {
    input.connection = WindingConnection::none;
    motor_.step(motor, input, step);
    account(0.0, step, chopper_on);
    return;
  }
  BridgeTerminals bridge{
      .diode_drop = drop, .open = state_.faults.open, .grounded = state_.faults.shorted};
  const int parts = static_cast<int>(std::ceil(step / kDiodeStep));
  const double part = step / parts;
  for (int n = 0; n < parts; ++n) {
    bridge.supply_voltage = state_.supply.voltage;
    const std::array<double, 3> before = phase_values(motor.current);
    const DiodeConduction conduction = diode_conduction(bridge, before, motor_.back_emf(motor));
    input.connection = conduction.connection;
    input.voltage = conduction.voltage;
    double power = motor_.step(motor, input, part);
    const std::array<double, 3> after =
        without_reverse_current(bridge, conduction, phase_values(motor.current));
    motor.current = stator_vector(after[0], after[1], after[2]);
    for (std::size_t k = 0; k < 3; ++k) {
      power += bridge.grounded[k] ? 0.0 : 0.5 * drop * (std::fabs(before[k]) + std::fabs(after[k]));
    }
    account(power, part, chopper_on);
  }
}

void ServoAxis::account(double power, double step, bool chopper_on) {
  state_.supply_power = power;
  state_.supplied_energy += power * step;
  const double inverse_voltage = 1.0 / std::max(state_.supply.voltage, kLowestVoltage);
  supply_.draw(state_.supply, power * inverse_voltage, step, chopper_on);
  state_.square_current += step * square(state_.motor.current);
  state_.heated_time += step;
}

void ServoAxis::update_temperatures() {
  const SynchronousMotorState& motor = state_.motor;
  const double elapsed = state_.unheated.seconds();
  // Settled steps were not added up: the current was what it is.
  const double settled = std::max(0.0, elapsed - state_.heated_time);
  const double mean_square = (state_.square_current + settled * square(motor.current)) / elapsed;
  const InverterParameters& inverter = parameters_.inverter;
  const double phases = 1.5 * mean_square;  // A^2, sum of the squares of the three
  const double stage_loss = inverter.on_resistance * phases +
                            inverter.switching_share * state_.supply.voltage * std::sqrt(phases);
  for (; state_.unheated >= kThermalPeriod; state_.unheated = state_.unheated - kThermalPeriod) {
    motor_thermal_.advance(state_.motor_temperature, motor_.resistance() * phases,
                           state_.ambient_temperature);
    stage_thermal_.advance(state_.stage_temperature, stage_loss, state_.ambient_temperature);
  }
  state_.square_current = 0.0;
  state_.heated_time = 0.0;
  motor_.set_temperatures(state_.motor_temperature.inner, state_.motor_temperature.outer);
  sensing_.driver_temperature = state_.stage_temperature.inner;
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

void ServoAxis::set_supply_voltage(double voltage) {
  state_.supply.source = voltage;
  if (supply_.ideal()) {
    state_.supply.voltage = voltage;
  }
  settled_ = false;
}

void ServoAxis::set_faults(const ServoAxisFaults& faults) {
  state_.faults = faults;
  faulty_ = faults != ServoAxisFaults{};
  settled_ = false;
}

void ServoAxis::lose_encoder_counts(std::int64_t counts) {
  state_.lost_counts += counts;
  settled_ = false;
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

void ServoAxis::sense_switches() {
  const double revolutions = motor_.shaft().revolutions(state_.motor.angle);
  sensing_.left_switch = parameters_.left_switch.level(revolutions, state_.left_by_hand);
  sensing_.right_switch = parameters_.right_switch.level(revolutions, state_.right_by_hand);
  sensing_.home_switch = parameters_.home_switch.level(revolutions, state_.home_by_hand);
}

void ServoAxis::press(bool& by_hand, bool pressed) {
  by_hand = pressed;
  sense_switches();
}

void ServoAxis::sense_currents() {
  const std::array<double, 3> current = phase_values(state_.motor.current);
  sensing_.phase_current =
      current_sensing_.exact() ? current : current_sensing_.measure(current, state_.noise);
}

void ServoAxis::sense_encoder() {
  const std::int64_t count = encoder_.count(state_.encoder);
  if (state_.faults.encoder_channel_lost) {
    state_.lost_counts = count - sensing_.encoder_count;
  }
  sensing_.encoder_count = count - state_.lost_counts;
  const bool index_lost = state_.faults.encoder_index_lost;
  if (index_lost) {
    state_.lost_passages = state_.encoder.index_passages - sensing_.encoder_index_passages;
  }
  const std::uint32_t passages = state_.encoder.index_passages - state_.lost_passages;
  if (passages != sensing_.encoder_index_passages) {
    sensing_.encoder_index_passages = passages;
    state_.index_count = encoder_.index_count(state_.encoder) - state_.lost_counts;
  }
  sensing_.encoder_index_count = state_.index_count;
  sensing_.encoder_index =
      index_lost ? parameters_.encoder.index_active_low : encoder_.index(state_.encoder);
}

std::uint8_t ServoAxis::hall_signal() const {
  unsigned signal = halls_.signal(state_.halls);
  if (faulty_) [[unlikely]] {
    if (state_.faults.halls_swapped) {
      signal = (signal & 4U) | ((signal & 1U) << 1) | ((signal >> 1) & 1U);
    }
    for (unsigned k = 0; k < 3; ++k) {
      const HallFault fault = state_.faults.halls[k];
      if (fault != HallFault::none) {
        signal =
            (signal & ~(1U << k)) | (static_cast<unsigned>(fault == HallFault::stuck_high) << k);
      }
    }
  }
  return static_cast<std::uint8_t>(signal);
}

ServoAxisObservation ServoAxis::observe() const {
  const SynchronousMotorState& motor = state_.motor;
  const ShaftMechanics& shaft = motor_.shaft();
  const ShaftMechanics::Frozen frozen =
      shaft.freeze(motor.angle, state_.external_torque, !state_.brake.open);
  ServoAxisObservation seen;
  seen.shaft_revolutions = shaft.revolutions(motor.angle);
  seen.shaft_angle = seen.shaft_revolutions * base::kTwoPi;
  seen.electrical_angle = motor.angle.angle;
  seen.speed = motor.speed;
  seen.electromagnetic_torque = motor_.electromagnetic_torque(motor);
  seen.cogging_torque = motor_.cogging_torque(motor);
  seen.load_torque = frozen.steady_torque;
  if (shaft.depends_on_position()) {
    seen.load_torque += shaft.positional_torque(frozen, 0.0, motor.speed);
    seen.end_stop_torque =
        shaft.has_end_stops() ? shaft.end_stop_torque(frozen, 0.0, motor.speed) : 0.0;
  }
  seen.direct_current = motor.direct_current();
  seen.quadrature_current = motor.quadrature_current();
  seen.phase_current = phase_values(motor.current);
  seen.back_emf = motor_.back_emf(motor);
  seen.supply_voltage = state_.supply.voltage;
  seen.supply_power = state_.supply_power;
  seen.supplied_energy = state_.supplied_energy;
  seen.winding_temperature = state_.motor_temperature.inner;
  seen.housing_temperature = state_.motor_temperature.outer;
  seen.driver_temperature = state_.stage_temperature.inner;
  return seen;
}

}  // namespace stator::plant
