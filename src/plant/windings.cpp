#include "plant/windings.hpp"

#include <algorithm>

#include "plant/diode_bridge.hpp"

namespace stator::plant {

namespace {

/// Parts of a step turn the fastest motion of the model by no more than this, rad.
constexpr double kLargestTurn = 0.33;

/// s, the longest step in which diodes carry current: they close and open at its ends only.
constexpr double kDiodeStep = 5e-6;

int parts_of(double turn) {
  return turn <= kLargestTurn ? 1 : static_cast<int>(std::ceil(turn / kLargestTurn));
}

/// A winding between two half bridges whose transistors are off: its voltage, V, and whether it
/// blocks.
struct Freewheel {
  double voltage = 0.0;
  bool blocks = false;
};
Freewheel freewheel(double current, double induced, double supply_voltage, double diode_drop) {
  const double reverse = supply_voltage + 2.0 * diode_drop;
  if (current != 0.0) {
    return {.voltage = current > 0.0 ? -reverse : reverse};
  }
  if (std::fabs(induced) <= reverse) {
    return {.blocks = true};
  }
  return {.voltage = induced > 0.0 ? reverse : -reverse};
}

/// `after` unless diodes would have had to let the current turn round.
double without_reversal(double before, double after, double induced) {
  const double direction = before != 0.0 ? before : -induced;
  return direction * after < 0.0 ? 0.0 : after;
}

}  // namespace

ThreePhaseWinding::Values ThreePhaseWinding::slopes(const Values& voltage) const {
  const StatorVector u = stator_vector(voltage[0], voltage[1], voltage[2]);
  const double resistance = motor_.resistance() + inverter_.on_resistance;
  const double emf = motor_.flux_linkage() * state_.speed * motor_.motor().pole_pairs;
  const double per_henry = 1.0 / inductance();
  return phase_values(
      {(u.alpha - resistance * state_.current.alpha + emf * state_.direction.sine) * per_henry,
       (u.beta - resistance * state_.current.beta - emf * state_.direction.cosine) * per_henry});
}

double ThreePhaseWinding::pass(const Values& voltage, const ShaftInput& shaft, double h) {
  SynchronousMotorInput input;
  input.voltage = stator_vector(voltage[0], voltage[1], voltage[2]);
  input.series_resistance = inverter_.on_resistance;
  input.torque = shaft.torque;
  input.brake_engaged = shaft.brake_engaged;
  const double turn = h * motor_.fastest_rate(state_, h);
  if (turn <= kLargestTurn && motor_.turns_freely(state_, input)) [[likely]] {
    return motor_.turn(state_, input, h) * h;
  }
  const int parts = parts_of(turn);
  const double part = h / parts;
  double energy = 0.0;
  for (int n = 0; n < parts; ++n) {
    energy += motor_.step(state_, input, part) * part;
  }
  return energy;
}

double ThreePhaseWinding::coast(double supply_voltage, const ShaftInput& shaft, double h) {
  SynchronousMotorInput input;
  input.torque = shaft.torque;
  input.brake_engaged = shaft.brake_engaged;
  const double drop = inverter_.diode_drop;
  const double rate = motor_.fastest_rate(state_, h);
  if (state_.current == StatorVector{} &&
      motor_.largest_line_to_line_emf(state_) < supply_voltage + 2.0 * drop) {
    input.connection = WindingConnection::none;
    const int parts = parts_of(h * rate);
    for (int n = 0; n < parts; ++n) {
      motor_.step(state_, input, h / parts);
    }
    return 0.0;
  }
  const int parts = std::max(parts_of(h * rate), static_cast<int>(std::ceil(h / kDiodeStep)));
  const double part = h / parts;
  double energy = 0.0;
  const BridgeTerminals bridge{.supply_voltage = supply_voltage, .diode_drop = drop};
  for (int n = 0; n < parts; ++n) {
    const Values before = currents();
    const DiodeConduction conduction = diode_conduction(bridge, before, motor_.back_emf(state_));
    input.connection = conduction.connection;
    input.voltage = conduction.voltage;
    energy += motor_.step(state_, input, part) * part;
    const Values after = without_reverse_current(bridge, conduction, currents());
    state_.current = stator_vector(after[0], after[1], after[2]);
    for (std::size_t k = 0; k < kBridges; ++k) {
      energy += 0.5 * drop * (std::fabs(before[k]) + std::fabs(after[k])) * part;
    }
  }
  return energy;
}

TwoPhaseWinding::TwoPhaseWinding(const StepperMotorParameters& motor, const MechanicalLoad& load,
                                 const InverterParameters& inverter, double revolutions)
    : inverter_(inverter), motor_(motor, load) {
  motor_.set_resistance(motor.resistance + 2.0 * inverter.on_resistance);
  state_.angle = motor_.angle_at(revolutions);
  direction_ = base::sine_cosine(state_.angle.angle);
}

std::array<double, 2> TwoPhaseWinding::current_slope(const std::array<double, 2>& voltage) const {
  const std::array<double, 2> induced = motor_.induced_voltage(direction_, state_.speed);
  const double per_henry = 1.0 / motor_.motor().inductance;
  std::array<double, 2> slope{};
  for (std::size_t k = 0; k < 2; ++k) {
    slope[k] =
        per_henry * (voltage[k] - motor_.motor().resistance * state_.current[k] - induced[k]);
  }
  return slope;
}

TwoPhaseWinding::Values TwoPhaseWinding::slopes(const Values& voltage) const {
  const std::array<double, 2> slope =
      current_slope({voltage[0] - voltage[1], voltage[2] - voltage[3]});
  return {slope[0], -slope[0], slope[1], -slope[1]};
}

double TwoPhaseWinding::pass_part(const HybridStepperInput& input, double h) {
  const std::array<double, 2> before = state_.current;
  const std::array<double, 2> slope_before = current_slope(input.voltage);
  motor_.step(state_, direction_, input, h);
  direction_ = base::sine_cosine(state_.angle.angle);
  const std::array<double, 2> slope_after = current_slope(input.voltage);
  double energy = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    // The mean of a cubic through both ends (Hermite).
    const double charge = h * (0.5 * (before[k] + state_.current[k]) +
                               h * (1.0 / 12.0) * (slope_before[k] - slope_after[k]));
    energy += input.open[k] ? 0.0 : input.voltage[k] * charge;
  }
  return energy;
}

double TwoPhaseWinding::pass(const Values& voltage, const ShaftInput& shaft, double h) {
  HybridStepperInput input;
  input.voltage = {voltage[0] - voltage[1], voltage[2] - voltage[3]};
  input.torque = shaft.torque;
  input.brake_engaged = shaft.brake_engaged;
  const int parts = parts_of(h * motor_.fastest_rate(state_));
  double energy = 0.0;
  for (int n = 0; n < parts; ++n) {
    energy += pass_part(input, h / parts);
  }
  return energy;
}

double TwoPhaseWinding::coast(double supply_voltage, const ShaftInput& shaft, double h) {
  HybridStepperInput input;
  input.torque = shaft.torque;
  input.brake_engaged = shaft.brake_engaged;
  const int parts = std::max(parts_of(h * motor_.fastest_rate(state_)),
                             static_cast<int>(std::ceil(h / kDiodeStep)));
  const double part = h / parts;
  double energy = 0.0;
  for (int n = 0; n < parts; ++n) {
    const std::array<double, 2> before = state_.current;
    const std::array<double, 2> induced = motor_.induced_voltage(direction_, state_.speed);
    for (std::size_t k = 0; k < 2; ++k) {
      const Freewheel wheel =
          freewheel(before[k], induced[k], supply_voltage, inverter_.diode_drop);
      input.voltage[k] = wheel.voltage;
      input.open[k] = wheel.blocks;
    }
    pass_part(input, part);
    for (std::size_t k = 0; k < 2; ++k) {
      state_.current[k] = without_reversal(before[k], state_.current[k], induced[k]);
      // Into the supply, against which the diodes' drop is not.
      const double flowed = 0.5 * part * (std::fabs(before[k]) + std::fabs(state_.current[k]));
      energy -= supply_voltage * flowed;
    }
  }
  return energy;
}

double DcWinding::pass(const Values& voltage, const ShaftInput& shaft, double h) {
  const DcMotorInput input{.voltage = voltage[0] - voltage[1],
                           .series_resistance = resistance(),
                           .torque = shaft.torque,
                           .brake_engaged = shaft.brake_engaged};
  const int parts = parts_of(h * motor_.fastest_rate());
  double energy = 0.0;
  for (int n = 0; n < parts; ++n) {
    energy += motor_.step(state_, input, h / parts) * (h / parts);
  }
  return energy;
}

double DcWinding::coast(double supply_voltage, const ShaftInput& shaft, double h) {
  DcMotorInput input{.torque = shaft.torque, .brake_engaged = shaft.brake_engaged};
  const int parts =
      std::max(parts_of(h * motor_.fastest_rate()), static_cast<int>(std::ceil(h / kDiodeStep)));
  const double part = h / parts;
  double energy = 0.0;
  for (int n = 0; n < parts; ++n) {
    const double before = state_.current;
    const double induced = motor_.motor().torque_constant * state_.speed;
    const Freewheel wheel = freewheel(before, induced, supply_voltage, inverter_.diode_drop);
    input.voltage = wheel.voltage;
    input.open = wheel.blocks;
    motor_.step(state_, input, part);
    state_.current = without_reversal(before, state_.current, induced);
    energy -= supply_voltage * 0.5 * part * (std::fabs(before) + std::fabs(state_.current));
  }
  return energy;
}

}  // namespace stator::plant
