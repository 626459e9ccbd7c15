#include <algorithm>
#include <array>
#include <cmath>

#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/power/diode_bridge.hpp"

// What the bridge does in the less usual cases: with faults, dead time, end stops, another form of
// the EMF, or switched off.

namespace stator::plant {

namespace {

/// s, the longest step in which diodes carry current: they close and open at its ends only.
constexpr double kDiodeStep = 5e-6;

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

void ServoAxis::drive(const base::ServoActuation& actuation, double step) {
  const InverterParameters& inverter = parameters_.inverter;
  std::array<double, 3> duty{};
  for (std::size_t k = 0; k < 3; ++k) {
    duty[k] = within_period(actuation.duty[k]);
  }
  SynchronousMotorInput input = motor_input();
  input.series_resistance = inverter.on_resistance;
  if (faulty_) {
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
    const DeadTimeDrop<3> dead = DeadTime(inverter, parameters_.motor.direct_inductance, step)
                                     .drop(supply, phase_values(state_.motor.current));
    lost_power = dead.lost_power;
    const StatorVector drop = stator_vector(dead.voltage[0], dead.voltage[1], dead.voltage[2]);
    input.voltage.alpha -= drop.alpha;
    input.voltage.beta -= drop.beta;
  }
  const double power = motor_.step(state_.motor, input, step) + lost_power;
  account(power, step, actuation.brake_chopper_on);
}

void ServoAxis::rectify(bool chopper_on, double step) {
  SynchronousMotorInput input = motor_input();
  SynchronousMotorState& motor = state_.motor;
  const double drop = parameters_.inverter.diode_drop;
  const bool currentless = motor.current == StatorVector{};
  if (currentless && !faulty_ &&
      motor_.largest_line_to_line_emf(motor) < state_.supply.voltage + 2.0 * drop) {
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

}  // namespace stator::plant
