#pragma once

#include <array>
#include <cstdint>

#include "base/axis_signals.hpp"
#include "base/sim_time.hpp"
#include "plant/hybrid_stepper.hpp"
#include "plant/incremental_encoder.hpp"
#include "plant/mechanical_load.hpp"
#include "plant/position_switch.hpp"
#include "plant/stepper_motor.hpp"

namespace stator::plant {

/// Everything behind the connectors of one stepper axis; fixed after construction.
struct StepperAxisParameters {
  StepperMotorParameters motor;
  MechanicalLoad load;
  double supply_voltage = 24.0;      ///< V at power-on
  double initial_revolutions = 0.0;  ///< where the shaft stands at power-on
  EncoderParameters encoder;
  PositionSwitch left_switch;
  PositionSwitch right_switch;
  PositionSwitch home_switch;
};

/// All that changes; copy it to take a snapshot.
struct StepperAxisState {
  HybridStepperState motor;
  EncoderState encoder;
  double supply_voltage = 24.0;  ///< V
  double external_torque = 0.0;  ///< N m on the shaft, positive = forward
};

/// What a laboratory would measure; for recording.
struct StepperAxisObservation {
  double shaft_angle = 0.0;             ///< rad, mechanical, since the zero of the shaft
  double shaft_revolutions = 0.0;       ///< the same in revolutions
  double speed = 0.0;                   ///< rad/s
  double electromagnetic_torque = 0.0;  ///< N m
  double load_angle = 0.0;              ///< rad, electrical, current vector ahead of rotor, -pi..pi
  double load_torque = 0.0;  ///< N m of load and outside, without friction, positive = forward
  std::array<double, 2> coil_current{};  ///< A
};

/// The physical world of one stepper axis: chopper, motor, load, encoder, switches.
///
/// The chopper is averaged: each inner step applies the voltage that brings the coil to its target
/// at the end of the step, limited to the supply. With the bridge disabled the diodes feed the coil
/// current back into the supply until it is 0; then the coil is open.
class StepperAxis {
 public:
  explicit StepperAxis(const StepperAxisParameters& parameters);

  /// Advances the world by `duration` (customarily 50 us; longer ones, and fast shafts, are divided
  /// into inner steps by the stability rule of HybridStepper) and reads the sensors.
  base::AxisSensing step(const base::AxisActuation& actuation, base::SimDuration duration);

  /// The sensors without letting time pass.
  [[nodiscard]] base::AxisSensing sense() const;
  [[nodiscard]] StepperAxisObservation observe() const;

  /// Torque on the shaft from outside (N m, positive = forward) until set again.
  void set_external_torque(double torque) {
    state_.external_torque = torque;
    settled_ = false;
  }
  /// Supply at the power stage, V (brown-out, over-voltage).
  void set_supply_voltage(double voltage) {
    state_.supply_voltage = voltage;
    settled_ = false;
  }

  [[nodiscard]] const StepperAxisParameters& parameters() const { return parameters_; }
  [[nodiscard]] const StepperAxisState& state() const { return state_; }
  void restore(const StepperAxisState& state) {
    state_ = state;
    settled_ = false;
  }

 private:
  void regulate_and_integrate(const base::AxisActuation& actuation, double step);

  StepperAxisParameters parameters_;
  HybridStepper motor_;
  IncrementalEncoder encoder_;
  StepperAxisState state_;
  double regulated_step_ = 0.0;  ///< s, for which current_gain_ holds
  double current_gain_ = 0.0;    ///< voltage per change of current within a step, L / h

  /// The last step changed nothing. The next one with the same inputs changes nothing either, for a
  /// step is a function of state and inputs: a shaft at rest costs no arithmetic.
  bool settled_ = false;
  base::AxisActuation settled_actuation_;
  base::SimDuration settled_duration_;
  base::AxisSensing settled_sensing_;
};

}  // namespace stator::plant
