#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "base/trigonometry.hpp"
#include "plant/dc_motor.hpp"
#include "plant/hybrid_stepper.hpp"
#include "plant/inverter.hpp"
#include "plant/mechanical_load.hpp"
#include "plant/supply.hpp"
#include "plant/synchronous_motor.hpp"

namespace stator::plant {

/// What acts on a shaft from outside.
struct ShaftInput {
  double torque = 0.0;  ///< N m, positive = forward
  bool brake_engaged = false;
};

// Motors as half bridges see them: each has kBridges terminals, of which terminal k takes the
// current currents()[k] (A, into the motor) and gets a voltage against ground. pass() lets time go
// by with voltages held and returns the energy (J) that went in by the terminals; coast() with all
// transistors off.

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
  double pass(const Values& voltage, const ShaftInput& shaft, double h);
  double coast(double supply_voltage, const ShaftInput& shaft, double h);

  [[nodiscard]] double inductance() const { return motor_.motor().direct_inductance; }
  [[nodiscard]] double speed() const { return state_.speed; }
  [[nodiscard]] const ElectricalAngle& angle() const { return state_.angle; }
  [[nodiscard]] base::SineCosine direction() const { return state_.direction; }
  [[nodiscard]] int pole_pairs() const { return motor_.motor().pole_pairs; }
  [[nodiscard]] double torque() const { return motor_.electromagnetic_torque(state_); }
  void refresh() { SynchronousMotor::refresh_direction(state_); }

  [[nodiscard]] SynchronousMotor& motor() { return motor_; }
  [[nodiscard]] const SynchronousMotorState& state() const { return state_; }
  [[nodiscard]] SynchronousMotorState& state() { return state_; }
  [[nodiscard]] const InverterParameters& inverter() const { return inverter_; }

 private:
  InverterParameters inverter_;
  SynchronousMotor motor_;
  SynchronousMotorState state_;
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
    const double slope = motor_.current_slope(state_, voltage[0] - voltage[1], resistance());
    return {slope, -slope};
  }
  double pass(const Values& voltage, const ShaftInput& shaft, double h);
  double coast(double supply_voltage, const ShaftInput& shaft, double h);

  [[nodiscard]] double inductance() const { return motor_.motor().inductance; }
  [[nodiscard]] double speed() const { return state_.speed; }
  [[nodiscard]] const ElectricalAngle& angle() const { return state_.angle; }
  [[nodiscard]] base::SineCosine direction() const { return base::sine_cosine(state_.angle.angle); }
  [[nodiscard]] static int pole_pairs() { return 1; }
  [[nodiscard]] double torque() const { return motor_.motor().torque_constant * state_.current; }
  void refresh() {}

  [[nodiscard]] const DcMotor& motor() const { return motor_; }
  [[nodiscard]] const DcMotorState& state() const { return state_; }
  [[nodiscard]] DcMotorState& state() { return state_; }

  [[nodiscard]] const InverterParameters& inverter() const { return inverter_; }

 private:
  [[nodiscard]] double resistance() const { return 2.0 * inverter_.on_resistance; }

  InverterParameters inverter_;
  DcMotor motor_;
  DcMotorState state_;
};

/// Lets one PWM period pass with the duties averaged over it; `dead_time` may be missing. Returns
/// the energy (J) the bridge took.
template <typename Winding>
double average_period(Winding& winding, const DeadTime* dead_time, Supply& supply,
                      SupplyState& state, const typename Winding::Values& duty,
                      const ShaftInput& shaft, bool chopper_on, double period) {
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
