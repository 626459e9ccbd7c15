#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/motors/dc_motor.hpp"
#include "stator/plant/motors/hybrid_stepper.hpp"
#include "stator/plant/motors/synchronous_motor.hpp"
#include "stator/plant/power/inverter.hpp"
#include "stator/plant/power/supply.hpp"

namespace stator::plant {

/// What acts on a shaft from outside.
struct ShaftInput {
  double torque = 0.0;  ///< N m, positive = forward
  bool brake_engaged = false;
};

/// Where the cables of a motor's terminals end instead of at their half bridges.
struct TerminalFaults {
  std::array<bool, 4> open{};      ///< nowhere: the cable is broken
  std::array<bool, 4> grounded{};  ///< on ground: shorted

  friend bool operator==(const TerminalFaults&, const TerminalFaults&) = default;
};

// Motors as half bridges see them: each has kBridges terminals, of which terminal k takes the
// current currents()[k] (A, into the motor) and gets a voltage against ground. pass() lets time go
// by with voltages held and returns the energy (J) that went in by the terminals; coast() with all
// transistors off. A grounded terminal's voltage is for the caller of pass() to hold at 0.
// square_current() is the sum of the squares of the phases' currents (A^2); each flows through
// kTerminalsPerPhase transistors.

/// Parts of a step turn the fastest motion of a model by no more than this, rad.
inline constexpr double kLargestTurn = 0.33;

/// Terminals U, V, W of a three-phase motor.
class ThreePhaseWinding {
 public:
  static constexpr std::size_t kBridges = 3;
  using Values = std::array<double, kBridges>;

  ThreePhaseWinding(const ThreePhaseMotorParameters& motor, const MechanicalLoad& load,
                    const InverterParameters& inverter, double revolutions)
      : inverter_(inverter), motor_(motor, load), state_(motor_.at(revolutions)) {}

  [[nodiscard]] Values currents() const { return phase_values(state_.current); }
  [[nodiscard]] Values slopes(const Values& voltage) const;  ///< A/s
  [[gnu::always_inline]] double pass(const Values& voltage, const ShaftInput& shaft, double h) {
    SynchronousMotorInput input;
    input.voltage = stator_vector(voltage[0], voltage[1], voltage[2]);
    input.connection = connection_;
    input.series_resistance = inverter_.on_resistance;
    input.torque = shaft.torque;
    input.brake_engaged = shaft.brake_engaged;
    const double turn = h * motor_.fastest_rate(state_, h);
    if (turn <= kLargestTurn && motor_.turns_freely(state_, input)) [[likely]] {
      return motor_.turn(state_, input, h) * h;
    }
    return pass_in_parts(input, turn, h);
  }
  double coast(double supply_voltage, const ShaftInput& shaft, double h);

  [[nodiscard]] double inductance() const { return motor_.motor().direct_inductance; }
  [[nodiscard]] double speed() const { return state_.speed; }
  [[nodiscard]] const ElectricalAngle& angle() const { return state_.angle; }
  [[nodiscard]] base::SineCosine direction() const { return state_.direction; }
  [[nodiscard]] int pole_pairs() const { return motor_.motor().pole_pairs; }
  [[nodiscard]] double torque() const { return motor_.electromagnetic_torque(state_); }
  void refresh() { SynchronousMotor::refresh_direction(state_); }

  static constexpr double kTerminalsPerPhase = 1.0;
  [[nodiscard]] double square_current() const {
    const StatorVector& i = state_.current;
    return 1.5 * (i.alpha * i.alpha + i.beta * i.beta);
  }
  [[nodiscard]] double resistance() const { return motor_.resistance(); }  ///< of a phase, ohm
  void set_temperatures(const ThermalState& motor) {
    motor_.set_temperatures(motor.inner, motor.outer);
  }
  void set_faults(const TerminalFaults& faults);
  void set_load(const MechanicalLoad& load) { motor_.set_load(load); }
  void stop() { state_.speed = 0.0; }  ///< at once
  [[nodiscard]] bool connected() const { return connection_ == WindingConnection::all; }

  [[nodiscard]] SynchronousMotor& motor() { return motor_; }
  [[nodiscard]] const SynchronousMotor& motor() const { return motor_; }
  [[nodiscard]] const SynchronousMotorState& state() const { return state_; }
  [[nodiscard]] SynchronousMotorState& state() { return state_; }
  [[nodiscard]] const InverterParameters& inverter() const { return inverter_; }

 private:
  double pass_in_parts(const SynchronousMotorInput& input, double turn, double h);

  InverterParameters inverter_;
  SynchronousMotor motor_;
  SynchronousMotorState state_;
  TerminalFaults faults_;
  WindingConnection connection_ = WindingConnection::all;  ///< by cables
};

/// Terminals X1, X2, Y1, Y2 of a two-phase motor.
class TwoPhaseWinding {
 public:
  static constexpr std::size_t kBridges = 4;
  using Values = std::array<double, kBridges>;

  TwoPhaseWinding(const StepperMotorParameters& motor, const MechanicalLoad& load,
                  const InverterParameters& inverter, double revolutions);

  [[nodiscard]] Values currents() const {
    return {state_.current[0], -state_.current[0], state_.current[1], -state_.current[1]};
  }
  [[nodiscard]] Values slopes(const Values& voltage) const;  ///< A/s
  double pass(const Values& voltage, const ShaftInput& shaft, double h);
  double coast(double supply_voltage, const ShaftInput& shaft, double h);

  [[nodiscard]] double inductance() const { return motor_.motor().inductance; }
  [[nodiscard]] double speed() const { return state_.speed; }
  [[nodiscard]] const ElectricalAngle& angle() const { return state_.angle; }
  [[nodiscard]] base::SineCosine direction() const { return direction_; }
  [[nodiscard]] int pole_pairs() const { return motor_.motor().pole_pairs; }
  [[nodiscard]] double torque() const { return motor_.electromagnetic_torque(state_); }
  void refresh() {}

  static constexpr double kTerminalsPerPhase = 2.0;
  [[nodiscard]] double square_current() const {
    return state_.current[0] * state_.current[0] + state_.current[1] * state_.current[1];
  }
  [[nodiscard]] double resistance() const { return resistance_; }  ///< of a phase, ohm
  void set_temperatures(const ThermalState& motor);
  void set_faults(const TerminalFaults& faults);
  void set_load(const MechanicalLoad& load) { motor_.set_load(load); }
  void stop() { state_.speed = 0.0; }  ///< at once

  /// Its resistance includes the transistors.
  [[nodiscard]] const HybridStepper& motor() const { return motor_; }
  [[nodiscard]] const HybridStepperState& state() const { return state_; }
  [[nodiscard]] HybridStepperState& state() { return state_; }

 private:
  [[nodiscard]] std::array<double, 2> current_slope(const std::array<double, 2>& voltage) const;
  double pass_part(const HybridStepperInput& input, double h);

  InverterParameters inverter_;
  HybridStepper motor_;
  HybridStepperState state_;
  base::SineCosine direction_{0.0, 1.0};
  double cold_resistance_;  ///< ohm at 25 degree Celsius
  double resistance_;
  TerminalFaults faults_;
  std::array<bool, 2> open_{};  ///< phases that a broken cable takes the current
};

/// The two terminals of a brushed DC motor.
class DcWinding {
 public:
  static constexpr std::size_t kBridges = 2;
  using Values = std::array<double, kBridges>;

  DcWinding(const DcMotorParameters& motor, const MechanicalLoad& load,
            const InverterParameters& inverter, double revolutions)
      : inverter_(inverter), motor_(motor, load), state_(motor_.at(revolutions)) {}

  [[nodiscard]] Values currents() const { return {state_.current, -state_.current}; }
  [[nodiscard]] Values slopes(const Values& voltage) const {  ///< A/s
    const double slope = motor_.current_slope(state_, voltage[0] - voltage[1], series_resistance());
    return {slope, -slope};
  }
  double pass(const Values& voltage, const ShaftInput& shaft, double h);
  double coast(double supply_voltage, const ShaftInput& shaft, double h);

  [[nodiscard]] double inductance() const { return motor_.motor().inductance; }
  [[nodiscard]] double speed() const { return state_.speed; }
  [[nodiscard]] const ElectricalAngle& angle() const { return state_.angle; }
  [[nodiscard]] base::SineCosine direction() const { return base::sine_cosine(state_.angle.angle); }
  [[nodiscard]] static int pole_pairs() { return 1; }
  [[nodiscard]] double torque() const { return motor_.torque_constant() * state_.current; }
  void refresh() {}

  static constexpr double kTerminalsPerPhase = 2.0;
  [[nodiscard]] double square_current() const { return state_.current * state_.current; }
  [[nodiscard]] double resistance() const { return motor_.resistance(); }  ///< ohm
  void set_temperatures(const ThermalState& motor) {
    motor_.set_temperatures(motor.inner, motor.outer);
  }
  void set_faults(const TerminalFaults& faults) { faults_ = faults; }
  void set_load(const MechanicalLoad& load) { motor_.set_load(load); }
  void stop() { state_.speed = 0.0; }  ///< at once

  [[nodiscard]] const DcMotor& motor() const { return motor_; }
  [[nodiscard]] const DcMotorState& state() const { return state_; }
  [[nodiscard]] DcMotorState& state() { return state_; }

  [[nodiscard]] const InverterParameters& inverter() const { return inverter_; }

 private:
  [[nodiscard]] double series_resistance() const { return 2.0 * inverter_.on_resistance; }
  [[nodiscard]] bool open() const { return faults_.open[0] || faults_.open[1]; }

  InverterParameters inverter_;
  DcMotor motor_;
  DcMotorState state_;
  TerminalFaults faults_;
};

/// Lets one PWM period pass with the duties averaged over it; `dead_time` may be missing. Returns
/// the energy (J) the bridge took.
template <typename Winding>
[[gnu::always_inline]] inline double average_period(Winding& winding, const DeadTime* dead_time,
                                                    Supply& supply, SupplyState& state,
                                                    const typename Winding::Values& duty,
                                                    const ShaftInput& shaft, bool chopper_on,
                                                    double period) {
  typename Winding::Values voltage{};
  for (std::size_t k = 0; k < Winding::kBridges; ++k) {
    voltage[k] = state.voltage * duty[k];
  }
  double lost = 0.0;
  if (dead_time != nullptr) {
    const auto dead = dead_time->drop(state.voltage, winding.currents());
    for (std::size_t k = 0; k < Winding::kBridges; ++k) {
      voltage[k] -= dead.voltage[k];
    }
    lost = dead.lost_power * period;
  }
  const double energy = winding.pass(voltage, shaft, period) + lost;
  supply.draw(state, energy * (1.0 / period), period, chopper_on);
  return energy;
}

}  // namespace stator::plant
