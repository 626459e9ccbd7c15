#include "stator/plant/power/windings.hpp"

#include <algorithm>

#include "stator/plant/power/diode_bridge.hpp"

namespace stator::plant {

namespace {

/// s, the longest step in which diodes carry current: they close and open at its ends only.
constexpr double kDiodeStep = 5e-6;

int parts_of(double turn) {
  return turn <= kLargestTurn ? 1 : static_cast<int>(std::ceil(turn / kLargestTurn));
}

/// A winding between two half bridges whose transistors are off, or whose terminals are shorted to
/// ground. A current into the first terminal flows through its lower diode and the second one's
/// upper diode.
class Freewheel {
 public:
  Freewheel(double supply_voltage, double diode_drop, bool first_grounded, bool second_grounded)
      : forward_((first_grounded ? 0.0 : -diode_drop) -
                 (second_grounded ? 0.0 : supply_voltage + diode_drop)),
        backward_((first_grounded ? 0.0 : supply_voltage + diode_drop) +
                  (second_grounded ? 0.0 : diode_drop)),
        into_supply_forward_(second_grounded ? 0.0 : supply_voltage),
        into_supply_backward_(first_grounded ? 0.0 : supply_voltage) {}

  /// Whether the winding carries no current, and goes on so.
  [[nodiscard]] bool blocks(double current, double induced) const {
    return current == 0.0 && induced >= forward_ && induced <= backward_ && forward_ < backward_;
  }
  /// V at the winding.
  [[nodiscard]] double voltage(double current, double induced) const {
    return forward(current, induced) ? forward_ : backward_;
  }
  /// V of the supply that its current flows against.
  [[nodiscard]] double into_supply(double current, double induced) const {
    return forward(current, induced) ? into_supply_forward_ : into_supply_backward_;
  }
  /// `after` unless diodes would have had to let the current turn round.
  [[nodiscard]] double without_reversal(double before, double after, double induced) const {
    const double direction = forward(before, induced) ? 1.0 : -1.0;
    return forward_ < backward_ && direction * after < 0.0 ? 0.0 : after;
  }

 private:
  [[nodiscard]] static bool forward(double current, double induced) {
    return current != 0.0 ? current > 0.0 : induced < 0.0;
  }

  double forward_;   ///< V while the current is positive
  double backward_;  ///< and negative
  double into_supply_forward_;
  double into_supply_backward_;
};

WindingConnection connection_of(const std::array<bool, 4>& open) {
  constexpr std::array kConnections{WindingConnection::all,       WindingConnection::without_u,
                                    WindingConnection::without_v, WindingConnection::none,
                                    WindingConnection::without_w, WindingConnection::none,
                                    WindingConnection::none,      WindingConnection::none};
  return kConnections[(open[0] ? 1U : 0U) + (open[1] ? 2U : 0U) + (open[2] ? 4U : 0U)];
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

double ThreePhaseWinding::pass_in_parts(const SynchronousMotorInput& input, double turn, double h) {
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
  if (state_.current == StatorVector{} && faults_ == TerminalFaults{} &&
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
  BridgeTerminals bridge{.supply_voltage = supply_voltage, .diode_drop = drop};
  std::copy_n(faults_.open.begin(), kBridges, bridge.open.begin());
  std::copy_n(faults_.grounded.begin(), kBridges, bridge.grounded.begin());
  for (int n = 0; n < parts; ++n) {
    const Values before = currents();
    const DiodeConduction conduction = diode_conduction(bridge, before, motor_.back_emf(state_));
    input.connection = conduction.connection;
    input.voltage = conduction.voltage;
    energy += motor_.step(state_, input, part) * part;
    const Values after = without_reverse_current(bridge, conduction, currents());
    state_.current = stator_vector(after[0], after[1], after[2]);
    for (std::size_t k = 0; k < kBridges; ++k) {
      energy += bridge.grounded[k]
                    ? 0.0
                    : 0.5 * drop * (std::fabs(before[k]) + std::fabs(after[k])) * part;
    }
  }
  return energy;
}

void ThreePhaseWinding::set_faults(const TerminalFaults& faults) {
  faults_ = faults;
  connection_ = connection_of(faults.open);
}

TwoPhaseWinding::TwoPhaseWinding(const StepperMotorParameters& motor, const MechanicalLoad& load,
                                 const InverterParameters& inverter, double revolutions)
    : inverter_(inverter),
      motor_(motor, load),
      cold_resistance_(motor.resistance),
      resistance_(motor.resistance) {
  motor_.set_resistance(resistance_ + kTerminalsPerPhase * inverter.on_resistance);
  state_.angle = motor_.angle_at(revolutions);
  direction_ = base::sine_cosine(state_.angle.angle);
}

void TwoPhaseWinding::set_temperatures(const ThermalState& motor) {
  constexpr double kSheetTemperature = 25.0;
  resistance_ = cold_resistance_ *
                (1.0 + motor_.motor().temperature_coefficient * (motor.inner - kSheetTemperature));
  motor_.set_resistance(resistance_ + kTerminalsPerPhase * inverter_.on_resistance);
}

void TwoPhaseWinding::set_faults(const TerminalFaults& faults) {
  faults_ = faults;
  for (std::size_t k = 0; k < 2; ++k) {
    open_[k] = faults.open[2 * k] || faults.open[2 * k + 1];
    state_.current[k] = open_[k] ? 0.0 : state_.current[k];
  }
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
  input.open = open_;
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
  const auto wheel = [&](std::size_t first) {
    return Freewheel(supply_voltage, inverter_.diode_drop, faults_.grounded[first],
                     faults_.grounded[first + 1]);
  };
  const std::array<Freewheel, 2> wheels{wheel(0), wheel(2)};
  double energy = 0.0;
  for (int n = 0; n < parts; ++n) {
    const std::array<double, 2> before = state_.current;
    const std::array<double, 2> induced = motor_.induced_voltage(direction_, state_.speed);
    for (std::size_t k = 0; k < 2; ++k) {
      input.voltage[k] = wheels[k].voltage(before[k], induced[k]);
      input.open[k] = open_[k] || wheels[k].blocks(before[k], induced[k]);
    }
    pass_part(input, part);
    for (std::size_t k = 0; k < 2; ++k) {
      state_.current[k] = wheels[k].without_reversal(before[k], state_.current[k], induced[k]);
      // Into the supply, against which the diodes' drop is not.
      const double flowed = 0.5 * part * (std::fabs(before[k]) + std::fabs(state_.current[k]));
      energy -= wheels[k].into_supply(before[k], induced[k]) * flowed;
    }
  }
  return energy;
}

double DcWinding::pass(const Values& voltage, const ShaftInput& shaft, double h) {
  const DcMotorInput input{.voltage = voltage[0] - voltage[1],
                           .series_resistance = series_resistance(),
                           .torque = shaft.torque,
                           .open = open(),
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
  const Freewheel wheel(supply_voltage, inverter_.diode_drop, faults_.grounded[0],
                        faults_.grounded[1]);
  for (int n = 0; n < parts; ++n) {
    const double before = state_.current;
    const double induced = motor_.torque_constant() * state_.speed;
    input.voltage = wheel.voltage(before, induced);
    input.open = open() || wheel.blocks(before, induced);
    motor_.step(state_, input, part);
    state_.current = wheel.without_reversal(before, state_.current, induced);
    energy -= wheel.into_supply(before, induced) * 0.5 * part *
              (std::fabs(before) + std::fabs(state_.current));
  }
  return energy;
}

}  // namespace stator::plant
