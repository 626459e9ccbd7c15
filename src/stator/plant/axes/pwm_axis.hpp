#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "stator/base/random.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/plant/axes/axis_faults.hpp"
#include "stator/plant/mechanics/holding_brake.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"
#include "stator/plant/power/inverter.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/power/windings.hpp"
#include "stator/plant/sensors/analog_position_sensor.hpp"
#include "stator/plant/sensors/current_converter.hpp"
#include "stator/plant/sensors/encoder_disturbance.hpp"
#include "stator/plant/sensors/hall_sensors.hpp"
#include "stator/plant/sensors/incremental_encoder.hpp"
#include "stator/plant/sensors/position_switch.hpp"

namespace stator::plant {

/// The motor of an axis: three-phase, two-phase stepper, or brushed DC.
using MotorParameters =
    std::variant<ThreePhaseMotorParameters, StepperMotorParameters, DcMotorParameters>;

enum class InverterModel : std::uint8_t {
  averaged,  ///< the duties give the mean voltages of a period
  switched,  ///< every edge is simulated: ripple of currents and supply, dead time by sign
};

/// Everything behind the connectors of an axis whose PWM periods are simulated one by one; fixed
/// after construction.
struct PwmAxisParameters {
  MotorParameters motor = *find_three_phase_motor("QBL4208-61-04-013");
  MechanicalLoad load;
  HoldingBrake brake;
  double supply_voltage = 24.0;  ///< V at power-on
  SupplyParameters supply{.capacitance = 470e-6, .source_resistance = 0.05};
  InverterParameters inverter;  ///< its pwm_frequency does not count: periods come with step()
  InverterModel inverter_model = InverterModel::averaged;
  double ambient_temperature = 25.0;  ///< degree Celsius at power-on; everything starts with it
  double initial_revolutions = 0.0;   ///< where the shaft stands at power-on
  ConverterParameters converter;
  HallSensorParameters halls;  ///< of a DC motor they see its shaft
  AnalogSensorParameters analog_halls{};
  AnalogSensorParameters analog_encoder{};
  std::array<EncoderParameters, 2> encoders{EncoderParameters{.counts_per_revolution = 4096},
                                            EncoderParameters{.counts_per_revolution = 0}};
  std::array<EncoderDisturbanceParameters, 2> encoder_disturbances;
  PositionSwitch left_switch;
  PositionSwitch right_switch;
  PositionSwitch home_switch;
  std::uint64_t noise_seed = 1;
};

/// What the power stage is told for one PWM period.
struct PwmActuation {
  bool bridge_enabled = false;    ///< false: all transistors off, currents decay in diodes
  std::array<double, 4> duty{};   ///< 0..1 of half bridges U, V, W or X1, X2, Y1, Y2 or the two of
                                  ///< a DC motor
  bool brake_released = true;     ///< holding brake, if one is fitted
  bool brake_chopper_on = false;  ///< the resistor across the supply conducts
  /// s for which the drive keeps both transistors of a half bridge off; with
  /// InverterParameters::dead_time, that of the stage, the longer one counts.
  double dead_time = 0.0;
};

/// What is broken.
struct PwmAxisFaults {
  TerminalFaults terminals{};  ///< cables of U, V, W or X1, X2, Y1, Y2 or the two of a DC motor
  bool high_side = false;      ///< a short in the stage itself: the motor gets no voltage
  std::array<HallFault, 3> halls{};  ///< of H1, H2, H3
  bool halls_swapped = false;        ///< the wires of H1 and H2 are swapped
  double converter_noise = 0.0;      ///< counts, standard deviation beside ConverterParameters'
  AxisFaults common{};               ///< what axes of every kind can have

  friend bool operator==(const PwmAxisFaults&, const PwmAxisFaults&) = default;
};

/// What a drive sees of one incremental encoder.
struct EncoderReading {
  std::int64_t count = 0;            ///< quadrature counts since power-on, not wrapped
  bool index = false;                ///< level of N
  std::uint32_t index_passages = 0;  ///< N pulses met since power-on, modulo 2^32
  std::int64_t index_count = 0;      ///< `count` at the latest N pulse
};

/// What the sensors tell at the end of a PWM period.
struct PwmSensing {
  ConverterSample converter;
  std::uint8_t halls = 0;  ///< bits 0, 1, 2: levels of H1, H2, H3
  std::array<std::uint16_t, 3> analog_halls{};
  std::array<std::uint16_t, 3> analog_encoder{};
  std::array<EncoderReading, 2> encoders{};
  bool left_switch = false;  ///< level of the input
  bool right_switch = false;
  bool home_switch = false;
  double driver_temperature = 25.0;   ///< degree Celsius of the transistors
  double winding_temperature = 25.0;  ///< degree Celsius
  std::array<bool, 4> overcurrent{};  ///< a driven terminal is shorted
  bool overcurrent_high_side = false;
};

/// What a laboratory would measure; for recording.
struct PwmAxisObservation {
  double shaft_angle = 0.0;             ///< rad, mechanical, since the zero of the shaft
  double shaft_revolutions = 0.0;       ///< the same in revolutions
  double electrical_angle = 0.0;        ///< rad, 0..2 pi; of a DC motor that of its shaft
  double speed = 0.0;                   ///< rad/s
  double electromagnetic_torque = 0.0;  ///< N m
  double cogging_torque = 0.0;  ///< N m of cogging or detent on the shaft, positive = forward
  double load_torque = 0.0;     ///< N m of load, stops and outside, without friction, positive =
                                ///< forward
  double direct_current = 0.0;  ///< A along the magnets, true; 0 of a DC motor
  double quadrature_current = 0.0;           ///< A across them, true; that of a DC motor
  std::array<double, 4> terminal_current{};  ///< A into the terminals, true
  double supply_voltage = 24.0;              ///< V at the power stage
  double supply_power = 0.0;                 ///< W the bridge took in the latest period, mean
  double supplied_energy = 0.0;              ///< J it took since power-on
  double winding_temperature = 25.0;         ///< degree Celsius
  double housing_temperature = 25.0;         ///< degree Celsius
  double driver_temperature = 25.0;          ///< degree Celsius of the transistors
  double board_temperature = 25.0;           ///< degree Celsius; converters stand on it
};

/// The physical world of an axis behind a motor control chip that drives half bridges and reads
/// converters: supply, inverter, motor with load, sensors with their errors, switches, heat. Copy
/// it to take a snapshot. Temperatures advance every 10 ms; resistance, flux and the drift of the
/// converters follow them.
class PwmAxis {
 public:
  explicit PwmAxis(const PwmAxisParameters& parameters);

  /// Lets one PWM period pass and samples the sensors.
  const PwmSensing& step(const PwmActuation& actuation, base::SimDuration period);
  [[nodiscard]] const PwmSensing& sensing() const { return sensing_; }

  /// Torque on the shaft from outside (N m, positive = forward) until set again.
  void set_external_torque(double torque) { shaft_.torque = torque; }
  /// V of the source (brown-out, over-voltage).
  void set_supply_voltage(double voltage);
  void set_ambient_temperature(double celsius) { ambient_temperature_ = celsius; }
  void set_faults(const PwmAxisFaults& faults);
  [[nodiscard]] const PwmAxisFaults& faults() const { return faults_; }
  /// The drive misses `counts` counts forward (negative: sees as many too much) of an encoder (0 or
  /// 1), at once.
  void lose_encoder_counts(std::size_t encoder, std::int64_t counts);

  /// Presses a switch by hand, or lets it go; its cam presses it all the same.
  void press_left_switch(bool pressed) { press(left_by_hand_, pressed); }
  void press_right_switch(bool pressed) { press(right_by_hand_, pressed); }
  void press_home_switch(bool pressed) { press(home_by_hand_, pressed); }

  [[nodiscard]] PwmAxisObservation observe() const;
  [[nodiscard]] std::array<double, 4> currents() const;  ///< A into the terminals, true
  [[nodiscard]] double speed() const;                    ///< rad/s
  [[nodiscard]] double revolutions() const;              ///< of the shaft since its zero
  [[nodiscard]] double electromagnetic_torque() const;   ///< N m
  [[nodiscard]] double supply_voltage() const { return supply_state_.voltage; }  ///< V
  /// J the bridge took since power-on, diodes included.
  [[nodiscard]] double bridge_energy() const { return bridge_energy_; }
  [[nodiscard]] const PwmAxisParameters& parameters() const { return parameters_; }

 private:
  using Winding = std::variant<ThreePhaseWinding, TwoPhaseWinding, DcWinding>;

  static Winding winding_of(const PwmAxisParameters& parameters);
  void set_period(base::SimDuration period, double dead_time);
  void press(bool& by_hand, bool pressed);
  template <typename Of>
  double pass(Of& winding, const PwmActuation& actuation, double period);
  template <typename Of>
  [[gnu::always_inline]] void sense(const Of& winding, double period);
  template <typename Of>
  [[gnu::always_inline]] void sense_encoders(const Of& winding, double period);
  void sense_switches();
  void sense_faults(bool bridge_enabled);
  void begin_encoder_faults();
  void spoil_encoder(std::size_t encoder, const ElectricalAngle& angle, double torque);
  template <typename Of>
  void update_temperatures(Of& winding);

  PwmAxisParameters parameters_;
  Winding winding_;
  Supply supply_;
  SupplyState supply_state_;
  ShaftInput shaft_;
  HoldingBrakeState brake_;
  TwoBodyThermal motor_thermal_;
  TwoBodyThermal stage_thermal_;
  ThermalState motor_temperature_;  ///< winding and housing
  ThermalState stage_temperature_;  ///< transistors and board
  double ambient_temperature_;      ///< degree Celsius
  base::SimDuration unheated_;      ///< time the temperatures do not know of yet
  double square_current_ = 0.0;     ///< A^2 s of all phases in that time
  bool faulty_ = false;             ///< there are any of terminals, stage or Hall sensors
  bool spoiled_ = false;            ///< or of the encoders
  bool has_switches_;
  bool left_by_hand_ = false;  ///< a hand presses the switch
  bool right_by_hand_ = false;
  bool home_by_hand_ = false;
  CurrentConverter converter_;
  ConverterState converter_state_;
  HallSensors halls_;
  std::uint8_t hall_levels_ = 0;
  InverterParameters inverter_;  ///< with the dead time and the PWM frequency in force
  double commanded_dead_time_ = 0.0;
  DeadTime dead_time_;        ///< for periods of the length below
  base::SimDuration period_;  ///< the latest
  double period_seconds_ = 0.0;
  AnalogPositionSensor analog_halls_;
  AnalogPositionSensor analog_encoder_;
  std::array<IncrementalEncoder, 2> encoders_;
  std::array<EncoderState, 2> encoder_states_;
  std::array<EncoderDisturbance, 2> disturbances_;
  std::array<EncoderDisturbanceState, 2> disturbance_states_;
  base::Random converter_noise_;
  base::Random angle_noise_;
  double period_energy_ = 0.0;  ///< J in the latest period
  double bridge_energy_ = 0.0;  ///< J
  PwmSensing sensing_;
  PwmAxisFaults faults_;
  AxisFaultState fault_state_;
};

}  // namespace stator::plant
