#pragma once

#include <array>
#include <cstdint>

#include "stator/base/axis_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/motion_controller/coil_current_selector.hpp"
#include "stator/control/motion_controller/encoder_interface.hpp"
#include "stator/control/motion_controller/motion_controller_ramp.hpp"
#include "stator/control/motion_controller/motion_controller_settings.hpp"
#include "stator/control/motion_controller/position_regulator.hpp"
#include "stator/control/motion_controller/stop_switches.hpp"
#include "stator/control/motion_controller/wave_table.hpp"

namespace stator::control::motion_controller {

/// What is on the step and direction outputs.
struct StepDirectionOutput {
  std::int64_t pulses = 0;        ///< since power-on; those of one period go one way
  bool forward = true;            ///< level of DIR: the motor's latest direction, after AP 19
  std::int64_t pulse_length = 0;  ///< ps (AP 64 * 62.5 ns); 0 = no pulses to be seen
  bool merged = false;            ///< in the latest period pulses were as long as their distance
};

/// The motion controller chip of the TMCM-142, a TMC457 at 16 MHz, with the firmware's supervision
/// of the encoder: what its axis parameters show and set, except those of unit conversion,
/// reference search (ReferenceSearch) and power stage.
///
/// How a device uses it. Once per control period (50 or 100 us, any multiple of 8 us; other periods
/// work, too) it calls
///
///   controller.advance(sensing, period);
///
/// with what the sensors tell at the begin of the period: switch pins (true = high), encoder count
/// and N channel. Afterwards table_phases() times current_scale() / 15 times 7 A are the coil
/// currents for its end, pid_velocity() the velocity. Configuration is a struct: copy settings(),
/// change what an axis parameter stands for, and give it to configure(); it acts at once, also in
/// motion. Reading an axis parameter that "is cleared by reading" is a function read_...(); the
/// ones without that word change nothing.
///
/// Time: simulated nanoseconds. Ramps are evaluated in closed form at the end of each period, to
/// one unit of every register, whatever the period; switches, encoder and commands act at the
/// begin of the next one; the regulator makes its updates every 8 us within it. One clock (62.5 ns)
/// is the unit of the step pulses' length only.
///
/// Units: microsteps; velocities and accelerations in those of motion_controller_units.hpp. No
/// function fails; values out of range count as the nearest one. No allocation; copies are
/// snapshots.
class MotionController {
 public:
  MotionController();

  void configure(const Settings& settings);
  [[nodiscard]] const Settings& settings() const { return settings_; }
  /// AP 43; also when the value is the one there is, since it asks for a clearing anew.
  void set_encoder_mode(std::uint32_t mode);
  /// AP 27, 0..11; computes the table, in which AP 29 then acts.
  void set_microstep_resolution(std::uint8_t index);
  [[nodiscard]] std::uint8_t microstep_resolution() const { return table_.resolution_index(); }

  // Motion. A command ends the stop that a deviation of the encoder has caused.

  /// MVP, AP 0: positioning mode.
  void move_to(std::int32_t target);
  /// ROR, ROL, MST: velocity mode; 0 brakes with AP 17.
  void rotate(std::int32_t velocity);
  /// AP 2: as rotate() in velocity mode, otherwise stored.
  void set_target_velocity(std::int32_t velocity);
  /// AP 128.
  void set_mode(Mode mode);
  /// The motor is not driven: velocity mode, velocity 0 at once, and the regulator pauses until the
  /// next motion command. To be called in every period in which that is so.
  void stop_undriven();
  /// AP 1: names the position anew without moving the motor. In positioning mode the motor then
  /// moves to its target, which keeps its number (A104).
  void set_position(std::int32_t position);
  /// Names the position anew, sets encoder and target position to it, and leaves the motor in
  /// velocity mode with velocity 0: the end of a reference search (A51).
  void set_reference(std::int32_t position);
  /// AP 41, where a device lets it be written (A34).
  void set_encoder_position(std::int32_t position) { encoder_.set_position(position); }
  /// AP 63, 0..8191.
  void set_table_position(int entry) { table_.set_position(entry); }
  /// AP 34 is written (A33).
  void clear_regulator_sum() { regulator_.clear_sum(); }
  /// While set, neither switches nor position limits stop the motor: a reference search does that
  /// itself (RFS-015).
  void ignore_stops(bool ignore);

  void advance(const base::AxisSensing& sensing, base::SimDuration period);

  [[nodiscard]] Mode mode() const { return ramp_.mode(); }                                // AP 128
  [[nodiscard]] std::int32_t target_position() const { return ramp_.target_position(); }  // AP 0
  [[nodiscard]] std::int32_t position() const { return ramp_.position(); }                // AP 1
  [[nodiscard]] std::int32_t target_velocity() const { return ramp_.target_velocity(); }  // AP 2
  [[nodiscard]] std::int32_t velocity() const { return ramp_.velocity(); }                // AP 3
  /// Microsteps the ramp has made since power-on, whatever AP 1 was set to, where the sensors were
  /// taken in last.
  [[nodiscard]] std::int64_t observed_travel() const { return observed_travel_; }
  /// The same at present.
  [[nodiscard]] std::int64_t travel() const { return ramp_.generator().motor_microsteps(); }
  [[nodiscard]] bool position_reached() const { return target_position() == position(); }  // AP 8
  [[nodiscard]] bool velocity_reached() const { return target_velocity() == velocity(); }  // AP 130
  /// The ramp's velocity is 0 and no motion is planned.
  [[nodiscard]] bool at_rest() const { return ramp_.at_rest(); }
  /// AP 129: bit 0 position reached, 1 velocity reached, 2 velocity 0, 3 encoder warning (A49).
  [[nodiscard]] std::uint32_t status_flags() const;
  /// Worth an event: see MotionControllerRamp.
  [[nodiscard]] bool bow_too_large() const { return ramp_.bow_too_large(); }

  [[nodiscard]] bool right_switch() const { return switches_.right(); }             // AP 10
  [[nodiscard]] bool left_switch() const { return switches_.left(); }               // AP 11
  [[nodiscard]] std::uint32_t switch_status() const { return switches_.status(); }  // AP 9
  std::uint32_t read_switch_status() { return switches_.read_status(); }
  [[nodiscard]] std::int32_t latched_position() const { return latched_position_; }  // AP 46

  [[nodiscard]] std::int32_t encoder_position() const { return encoder_.position(); }  // AP 41
  [[nodiscard]] bool encoder_status() const { return encoder_.status(); }              // AP 44
  bool read_encoder_status() { return encoder_.read_status(); }
  [[nodiscard]] std::int32_t encoder_latch() const { return encoder_.latched(); }  // AP 45
  /// AP 207: bit 1 stopped by the encoder's deviation (A52, A53).
  [[nodiscard]] std::uint32_t error_flags() const { return deviation_flag_ ? 2U : 0U; }
  std::uint32_t read_error_flags();
  /// The motor is stopped because of the deviation, until the next motion command.
  [[nodiscard]] bool stopped_by_deviation() const { return stopped_by_deviation_; }

  [[nodiscard]] std::int32_t regulator_sum() const { return regulator_.sum(); }      // AP 34
  [[nodiscard]] std::int32_t regulator_error() const { return regulator_.error(); }  // AP 38
  /// AP 39: velocity of ramp and regulator together (A29).
  [[nodiscard]] std::int32_t pid_velocity() const;

  [[nodiscard]] int table_position() const { return table_.position(); }  // AP 63
  [[nodiscard]] const WaveTable& table() const { return table_; }
  /// Microsteps the sequencer has made since power-on, untouched by set_position(); without AP 19.
  [[nodiscard]] std::int64_t motor_microsteps() const { return microsteps_; }
  /// Parts of full current, -1..1, in phases A and B.
  [[nodiscard]] std::array<double, 2> table_phases() const { return table_.phases(); }
  /// AP 6 or, after the delay of AP 20, AP 7: 0..15.
  [[nodiscard]] std::uint8_t current_scale() const { return current_scale_; }
  /// The motor has not been told to move in the latest period: AP 22 instead of AP 21 holds.
  [[nodiscard]] bool standing() const { return !moving_; }
  [[nodiscard]] const StepDirectionOutput& step_direction() const { return step_direction_; }
  /// Pulses of the FS output since power-on (HW-010).
  [[nodiscard]] std::int64_t full_step_pulses() const { return full_step_pulses_; }

 private:
  void observe(const base::AxisSensing& sensing);
  void supervise();
  void begin_motion();
  void move_sequencer(base::SimDuration period);
  [[nodiscard]] std::int64_t sequencer_target() const;
  [[nodiscard]] std::int64_t deviation() const;

  Settings settings_;
  MotionControllerRamp ramp_;
  StopSwitches switches_;
  EncoderInterface encoder_;
  PositionRegulator regulator_;
  WaveTable table_;
  CoilCurrentSelector current_selector_;

  bool stops_ignored_ = false;
  bool stopped_by_deviation_ = false;
  bool deviation_flag_ = false;
  bool encoder_warning_ = false;
  bool moving_ = false;
  std::int64_t observed_travel_ = 0;
  std::int32_t latched_position_ = 0;
  std::int64_t microsteps_ = 0;
  std::uint8_t current_scale_ = 0;
  StepDirectionOutput step_direction_;
  std::int64_t full_step_pulses_ = 0;
};

}  // namespace stator::control::motion_controller
