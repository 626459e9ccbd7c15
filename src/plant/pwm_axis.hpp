#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "base/random.hpp"
#include "base/sim_time.hpp"
#include "plant/analog_position_sensor.hpp"
#include "plant/current_converter.hpp"
#include "plant/encoder_disturbance.hpp"
#include "plant/hall_sensors.hpp"
#include "plant/holding_brake.hpp"
#include "plant/incremental_encoder.hpp"
#include "plant/inverter.hpp"
#include "plant/mechanical_load.hpp"
#include "plant/supply.hpp"
#include "plant/windings.hpp"

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
  InverterParameters inverter;
  InverterModel inverter_model = InverterModel::averaged;
  double temperature = 25.0;         ///< degree Celsius of the converter's surroundings
  double initial_revolutions = 0.0;  ///< where the shaft stands at power-on
  ConverterParameters converter;
  HallSensorParameters halls;  ///< of a DC motor they see its shaft
  AnalogSensorParameters analog_halls{};
  AnalogSensorParameters analog_encoder{};
  std::array<EncoderParameters, 2> encoders{EncoderParameters{.counts_per_revolution = 4096},
                                            EncoderParameters{.counts_per_revolution = 0}};
  std::array<EncoderDisturbanceParameters, 2> encoder_disturbances;
  std::uint64_t noise_seed = 1;
};

/// What the power stage is told for one PWM period.
struct PwmActuation {
  bool bridge_enabled = false;    ///< false: all transistors off, currents decay in diodes
  std::array<double, 4> duty{};   ///< 0..1 of half bridges U, V, W or X1, X2, Y1, Y2 or the two of
                                  ///< a DC motor
  bool brake_released = true;     ///< holding brake, if one is fitted
  bool brake_chopper_on = false;  ///< the resistor across the supply conducts
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
};

/// The physical world of an axis behind a motor control chip that drives half bridges and reads
/// converters: supply, inverter, motor with load, sensors with their errors. Copy it to take a
/// snapshot.
class PwmAxis {
 public:
  explicit PwmAxis(const PwmAxisParameters& parameters);

  /// Lets one PWM period pass and samples the sensors.
  const PwmSensing& step(const PwmActuation& actuation, base::SimDuration period);
  [[nodiscard]] const PwmSensing& sensing() const { return sensing_; }

  /// Torque on the shaft from outside (N m, positive = forward) until set again.
  void set_external_torque(double torque) { shaft_.torque = torque; }
  void set_supply_voltage(double voltage);  ///< V of the source

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
  void set_period(base::SimDuration period);
  template <typename Of>
  double pass(Of& winding, const PwmActuation& actuation, double period);
  template <typename Of>
  void sense(const Of& winding, double period);
  void sense_encoders(const ElectricalAngle& angle, double period);

  PwmAxisParameters parameters_;
  Winding winding_;
  Supply supply_;
  SupplyState supply_state_;
  ShaftInput shaft_;
  HoldingBrakeState brake_;
  CurrentConverter converter_;
  ConverterState converter_state_;
  HallSensors halls_;
  std::uint8_t hall_levels_ = 0;
  DeadTime dead_time_;  ///< for periods of the length below
  base::SimDuration dead_time_period_;
  AnalogPositionSensor analog_halls_;
  AnalogPositionSensor analog_encoder_;
  std::array<IncrementalEncoder, 2> encoders_;
  std::array<EncoderState, 2> encoder_states_;
  std::array<EncoderDisturbance, 2> disturbances_;
  std::array<EncoderDisturbanceState, 2> disturbance_states_;
  base::Random converter_noise_;
  base::Random angle_noise_;
  base::SimDuration unrefreshed_;
  double bridge_energy_ = 0.0;
  PwmSensing sensing_;
};

}  // namespace stator::plant
