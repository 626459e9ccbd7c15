#pragma once

#include <array>
#include <cstdint>

#include "stator/base/random.hpp"
#include "stator/base/servo_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/plant/axes/axis_faults.hpp"
#include "stator/plant/mechanics/holding_brake.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/motors/synchronous_motor.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"
#include "stator/plant/power/inverter.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/sensors/current_sensing.hpp"
#include "stator/plant/sensors/hall_sensors.hpp"
#include "stator/plant/sensors/incremental_encoder.hpp"
#include "stator/plant/sensors/position_switch.hpp"

namespace stator::plant {

/// Everything behind the connectors of one servo axis; fixed after construction.
struct ServoAxisParameters {
  /// The motor a TMCC160 is usually seen with.
  ThreePhaseMotorParameters motor = *find_three_phase_motor("QBL4208-61-04-013");
  MechanicalLoad load;
  HoldingBrake brake;
  double supply_voltage = 24.0;  ///< V at power-on
  /// Its chopper_voltage may stay infinite: ServoActuation::brake_chopper_on switches the resistor.
  SupplyParameters supply{.capacitance = 470e-6, .source_resistance = 0.05};
  InverterParameters inverter;
  double ambient_temperature = 25.0;  ///< degree Celsius at power-on; everything starts with it
  double initial_revolutions = 0.0;   ///< where the shaft stands at power-on
  HallSensorParameters halls;
  EncoderParameters encoder{.counts_per_revolution = 4096};
  CurrentSensingParameters current_sensing;
  std::uint64_t noise_seed = 1;
  PositionSwitch left_switch;
  PositionSwitch right_switch;
  PositionSwitch home_switch;
};

/// What is broken.
struct ServoAxisFaults {
  std::array<bool, 3> open{};        ///< the cable of phase U, V or W is broken
  std::array<bool, 3> shorted{};     ///< phase U, V or W is shorted to ground
  bool high_side = false;            ///< a short in the stage itself: the phases get no voltage
  std::array<HallFault, 3> halls{};  ///< of H1, H2, H3
  bool halls_swapped = false;        ///< the wires of H1 and H2 are swapped
  double current_noise = 0.0;        ///< A, standard deviation beside CurrentSensingParameters'
  AxisFaults common{};               ///< what axes of every kind can have

  friend bool operator==(const ServoAxisFaults&, const ServoAxisFaults&) = default;
};

/// All that changes; copy it to take a snapshot.
struct ServoAxisState {
  SynchronousMotorState motor;
  EncoderState encoder;
  std::uint8_t halls = 0;  ///< levels of the comparators
  HoldingBrakeState brake;
  SupplyState supply;
  double external_torque = 0.0;  ///< N m on the shaft, positive = forward
  bool left_by_hand = false;     ///< a hand presses the switch
  bool right_by_hand = false;
  bool home_by_hand = false;
  base::Random noise{1};

  ThermalState motor_temperature;     ///< winding and housing
  ThermalState stage_temperature;     ///< transistors and board
  double ambient_temperature = 25.0;  ///< degree Celsius
  base::SimDuration unheated;         ///< time the temperatures do not know of yet
  double heated_time = 0.0;           ///< s of it that square_current covers
  double square_current = 0.0;        ///< A^2 s of id^2 + iq^2 in that time
  double supply_power = 0.0;          ///< W the bridge took in the latest inner step, mean
  double supplied_energy = 0.0;       ///< J it took since power-on
  ServoAxisFaults faults;
  AxisFaultState fault_state;
};

/// What a laboratory would measure; for recording.
struct ServoAxisObservation {
  double shaft_angle = 0.0;             ///< rad, mechanical, since the zero of the shaft
  double shaft_revolutions = 0.0;       ///< the same in revolutions
  double electrical_angle = 0.0;        ///< rad, 0..2 pi, of the magnet ahead of phase U
  double speed = 0.0;                   ///< rad/s
  double electromagnetic_torque = 0.0;  ///< N m
  double cogging_torque = 0.0;          ///< N m, positive = forward
  double load_torque = 0.0;      ///< N m of load, stops and outside, without friction, positive =
                                 ///< forward
  double end_stop_torque = 0.0;  ///< N m of load_torque with which an end stop pushes back
  double direct_current = 0.0;   ///< A, true
  double quadrature_current = 0.0;        ///< A, true
  std::array<double, 3> phase_current{};  ///< A, true
  std::array<double, 3> back_emf{};       ///< V, phase to star point
  double supply_voltage = 24.0;           ///< V at the power stage
  double supply_power = 0.0;              ///< W the bridge took in the latest step, mean
  double supplied_energy = 0.0;           ///< J it took since power-on
  double winding_temperature = 25.0;      ///< degree Celsius
  double housing_temperature = 25.0;      ///< degree Celsius
  double driver_temperature = 25.0;       ///< degree Celsius
};

/// The physical world of one servo axis: supply, inverter, three-phase motor, load, Hall sensors,
/// encoder, current sensing, switches, heat.
///
/// The inverter is averaged over the step: the duties of the phases, dead time and on-resistance
/// give the voltages. With the bridge disabled its diodes rectify: the current decays into the
/// supply, and an EMF above the supply charges the capacitor and brakes the shaft. Temperatures
/// advance every 10 ms; resistance and flux follow them.
class ServoAxis {
 public:
  explicit ServoAxis(const ServoAxisParameters& parameters);

  /// Advances the world by `duration`, customarily one period of the current loop (longer ones, and
  /// fast shafts, are divided into inner steps), and reads the sensors.
  const base::ServoSensing& step(const base::ServoActuation& actuation, base::SimDuration duration);

  /// How many further steps like the latest one would change nothing but the time until
  /// temperatures are next looked at; 0 while anything moves.
  [[nodiscard]] std::int64_t restful_steps() const;
  /// Lets so many of them pass.
  void rest(std::int64_t steps) { state_.unheated += settled_duration_ * steps; }

  /// What the sensors told at the end of the latest step.
  [[nodiscard]] const base::ServoSensing& sensing() const { return sensing_; }
  [[nodiscard]] ServoAxisObservation observe() const;

  /// Torque on the shaft from outside (N m, positive = forward) until set again.
  void set_external_torque(double torque);
  /// Voltage of the source, V (brown-out, over-voltage).
  void set_supply_voltage(double voltage);
  void set_ambient_temperature(double celsius) { state_.ambient_temperature = celsius; }
  void set_faults(const ServoAxisFaults& faults);
  [[nodiscard]] const ServoAxisFaults& faults() const { return state_.faults; }
  /// The drive misses `counts` encoder counts forward (negative: sees as many too much), at once.
  void lose_encoder_counts(std::int64_t counts);

  /// Presses a switch by hand, or lets it go; its cam presses it all the same.
  void press_left_switch(bool pressed) { press(state_.left_by_hand, pressed); }
  void press_right_switch(bool pressed) { press(state_.right_by_hand, pressed); }
  void press_home_switch(bool pressed) { press(state_.home_by_hand, pressed); }

  [[nodiscard]] const ServoAxisParameters& parameters() const { return parameters_; }
  [[nodiscard]] const ServoAxisState& state() const { return state_; }
  void restore(const ServoAxisState& state);

 private:
  void press(bool& by_hand, bool pressed);
  /// Advances a standing shaft and notes whether anything changed.
  void step_and_settle(const base::ServoActuation& actuation, base::SimDuration duration);
  void pass(const base::ServoActuation& actuation, base::SimDuration duration);
  void pass_in_parts(const base::ServoActuation& actuation, double duration);
  /// Share of the period that a half bridge makes of a duty.
  [[nodiscard]] static double within_period(double duty) {
    const double positive = duty < 0.0 ? 0.0 : duty;
    return positive > 1.0 ? 1.0 : positive;
  }
  /// The bridge drives a motor that turns freely, nothing being wrong: what an axis does most.
  void turn(const base::ServoActuation& actuation, double step);
  void drive(const base::ServoActuation& actuation, double step);
  void rectify(bool chopper_on, double step);
  void account(double power, double step, bool chopper_on);
  [[nodiscard]] SynchronousMotorInput motor_input() const;
  /// Takes over what the faults make of load, supply and sensors.
  void apply_faults();
  void spoil_encoder();
  void spoil_encoder_reading();
  void sense_angle();
  void sense();
  void sense_encoder();
  void sense_currents();
  void sense_switches();
  [[nodiscard]] std::uint8_t hall_signal() const;
  void update_temperatures();

  ServoAxisParameters parameters_;
  SynchronousMotor motor_;
  IncrementalEncoder encoder_;
  HallSensors halls_;
  CurrentSensing current_sensing_;
  Supply supply_;
  TwoBodyThermal motor_thermal_;
  TwoBodyThermal stage_thermal_;
  bool has_switches_;
  ServoAxisState state_;
  base::ServoSensing sensing_;
  bool faulty_ = false;   ///< state_.faults has any of phases, stage or Hall sensors
  bool spoiled_ = false;  ///< or of the encoder
  bool plain_ = false;    ///< turn() will do while the shaft turns and the bridge drives it

  /// The last step changed nothing. The next one with the same inputs changes nothing either, for a
  /// step is a function of state and inputs: a shaft at rest costs no arithmetic.
  bool settled_ = false;
  base::ServoActuation settled_actuation_;
  base::SimDuration settled_duration_;
};

}  // namespace stator::plant
