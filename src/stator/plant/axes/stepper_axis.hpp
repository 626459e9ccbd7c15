#pragma once

#include <array>
#include <cstdint>

#include "stator/base/axis_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/plant/axes/axis_faults.hpp"
#include "stator/plant/mechanics/holding_brake.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/motors/hybrid_stepper.hpp"
#include "stator/plant/motors/stepper_motor.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/sensors/incremental_encoder.hpp"
#include "stator/plant/sensors/position_switch.hpp"

namespace stator::plant {

/// The power stage as its losses see it. The defaults are those of a 3 A stage on a small board.
struct DriverStageParameters {
  double on_resistance = 0.06;    ///< ohm of the transistors in the path of a coil's current
  double switching_share = 2e-3;  ///< time spent switching: W per V and A
  /// Chip inside, board outside.
  ThermalParameters thermal{.inner_capacity = 0.1,
                            .outer_capacity = 4.0,
                            .inner_to_outer = 8.0,
                            .outer_to_ambient = 20.0};
};

/// Everything behind the connectors of one stepper axis; fixed after construction.
struct StepperAxisParameters {
  StepperMotorParameters motor;
  MechanicalLoad load;
  HoldingBrake brake;
  double supply_voltage = 24.0;  ///< V at power-on
  SupplyParameters supply;
  DriverStageParameters driver;
  double ambient_temperature = 25.0;  ///< degree Celsius at power-on; everything starts with it
  double initial_revolutions = 0.0;   ///< where the shaft stands at power-on
  EncoderParameters encoder;
  PositionSwitch left_switch;
  PositionSwitch right_switch;
  PositionSwitch home_switch;
};

/// What is broken.
struct StepperAxisFaults {
  std::array<bool, 2> open{};     ///< the cable of phase A or B is broken
  std::array<bool, 2> shorted{};  ///< an output of phase A or B is shorted
  bool high_side = false;         ///< a short in the stage itself: both phases get no voltage
  AxisFaults common{};            ///< what axes of every kind can have

  friend bool operator==(const StepperAxisFaults&, const StepperAxisFaults&) = default;
};

/// What the chopper met in the latest step.
struct ChopperObservation {
  double induced_voltage = 0.0;  ///< V, signed amplitude of the EMF
  double converted_power = 0.0;  ///< W given to the shaft
  bool regulated = true;         ///< the supply sufficed
};

/// All that changes; copy it to take a snapshot.
struct StepperAxisState {
  HybridStepperState motor;
  EncoderState encoder;
  HoldingBrakeState brake;
  SupplyState supply;
  double external_torque = 0.0;                 ///< N m on the shaft, positive = forward
  std::array<double, 2> coil_current_target{};  ///< A, of the latest step; 0 while disabled
  bool left_by_hand = false;                    ///< a hand presses the switch
  bool right_by_hand = false;
  bool home_by_hand = false;
  ChopperObservation chopper;

  ThermalState motor_temperature;     ///< winding and housing
  ThermalState driver_temperature;    ///< chip and board
  double ambient_temperature = 25.0;  ///< degree Celsius
  base::SimDuration unheated;         ///< time the temperatures do not know of yet
  double heated_time = 0.0;           ///< s of it that square_current covers
  double square_current = 0.0;        ///< A^2 s of both phases in that time
  StepperAxisFaults faults;
  AxisFaultState fault_state;
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
  double winding_temperature = 25.0;     ///< degree Celsius
  double housing_temperature = 25.0;     ///< degree Celsius
  double driver_temperature = 25.0;      ///< degree Celsius
};

/// The physical world of one stepper axis: supply, chopper, motor, load, encoder, switches, heat.
///
/// The chopper is averaged: each inner step applies the voltage that brings the coil to its target
/// at the end of the step, limited to the supply. Where a fast shaft needs several inner steps the
/// target moves from one to the next in a straight line, as that of a sequencer does: a staircase
/// would cost a saturated chopper up to a tenth of its torque. In voltage mode it applies the share
/// of the supply it is told, and the current is what resistance, inductance and EMF make of it.
/// No shaft turns faster than 10,000 rad/s: what would drive it there has broken it before.
/// With the bridge disabled the diodes feed the coil current back into the supply until it is 0;
/// then the coil is open. Temperatures advance every millisecond; the resistance follows that of
/// the winding.
class StepperAxis {
 public:
  explicit StepperAxis(const StepperAxisParameters& parameters);

  /// Advances the world by `duration` (customarily 50 us; longer ones, and fast shafts, are divided
  /// into inner steps by the stability rule of HybridStepper) and reads the sensors.
  const base::AxisSensing& step(const base::AxisActuation& actuation, base::SimDuration duration);

  /// What the sensors told at the end of the latest step.
  [[nodiscard]] const base::AxisSensing& sensing() const { return sensing_; }

  /// The sensors without letting time pass.
  [[nodiscard]] base::AxisSensing sense() const;
  [[nodiscard]] StepperAxisObservation observe() const;

  /// Torque on the shaft from outside (N m, positive = forward) until set again.
  void set_external_torque(double torque) {
    state_.external_torque = torque;
    settled_ = false;
  }
  /// Voltage of the source, V (brown-out, over-voltage).
  void set_supply_voltage(double voltage);
  void set_ambient_temperature(double celsius) { state_.ambient_temperature = celsius; }
  void set_faults(const StepperAxisFaults& faults);
  [[nodiscard]] const StepperAxisFaults& faults() const { return state_.faults; }
  /// The drive misses `counts` encoder counts forward (negative: sees as many too much), at once.
  void lose_encoder_counts(std::int64_t counts);

  /// Presses a switch by hand, or lets it go; its cam presses it all the same.
  void press_left_switch(bool pressed) { press(state_.left_by_hand, pressed); }
  void press_right_switch(bool pressed) { press(state_.right_by_hand, pressed); }
  void press_home_switch(bool pressed) { press(state_.home_by_hand, pressed); }

  [[nodiscard]] const StepperAxisParameters& parameters() const { return parameters_; }
  [[nodiscard]] const StepperAxisState& state() const { return state_; }
  void restore(const StepperAxisState& state);
  /// Resistance of a phase at the winding's present temperature, ohm.
  [[nodiscard]] double resistance() const { return motor_.motor().resistance; }

 private:
  /// Electrical rad/s^2 that the torque from outside alone would cause.
  [[nodiscard]] double outside_acceleration() const {
    const double torque = state_.external_torque;
    return (torque < 0.0 ? -torque : torque) * electrical_per_torque_;
  }
  void press(bool& by_hand, bool pressed) {
    by_hand = pressed;
    settled_ = false;
  }
  void regulate_and_integrate(const base::AxisActuation& actuation, double step);
  /// `actuation` with targets between the last ones and its own; `left` 1..0 is the way still to
  /// go.
  [[nodiscard]] base::AxisActuation on_the_way(const base::AxisActuation& actuation,
                                               double left) const;
  [[nodiscard]] HybridStepperInput phase_input(const base::AxisActuation& actuation,
                                               const std::array<double, 2>& induced, double step,
                                               std::array<bool, 2>& runs_dry);
  void observe_chopper(const std::array<double, 2>& induced,
                       const std::array<double, 2>& current_before, const HybridStepperInput& input,
                       double step);
  void sense_into(base::AxisSensing& sensing) const;
  /// Takes over what the faults make of load, supply and sensors.
  void apply_faults();
  void spoil_encoder();
  void spoil_sensors();
  void update_temperatures();
  void follow_winding_temperature();

  StepperAxisParameters parameters_;
  HybridStepper motor_;
  IncrementalEncoder encoder_;
  Supply supply_;
  TwoBodyThermal motor_thermal_;
  TwoBodyThermal driver_thermal_;
  double electrical_per_torque_;  ///< pole pairs over inertia
  bool has_switches_;
  StepperAxisState state_;
  base::AxisSensing sensing_;
  double regulated_step_ = 0.0;  ///< s, for which current_gain_ holds
  double current_gain_ = 0.0;    ///< voltage per change of current within a step, L / h
  bool faulty_ = false;          ///< state_.faults has any of phases or stage
  bool spoiled_ = false;         ///< or of sensors

  /// The last step changed nothing. The next one with the same inputs changes nothing either, for a
  /// step is a function of state and inputs: a shaft at rest costs no arithmetic.
  bool settled_ = false;
  base::AxisActuation settled_actuation_;
  base::SimDuration settled_duration_;
};

}  // namespace stator::plant
