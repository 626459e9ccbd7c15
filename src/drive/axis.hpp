#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "base/axis_signals.hpp"
#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "dictionary/dictionary.hpp"
#include "drive/axis_error.hpp"
#include "drive/axis_motion.hpp"
#include "drive/axis_objects.hpp"
#include "drive/axis_settings.hpp"
#include "drive/closed_loop_conditions.hpp"
#include "drive/cyclic_modes.hpp"
#include "drive/driver_chip.hpp"
#include "drive/homing_mode.hpp"
#include "drive/position_capture.hpp"
#include "drive/position_feedback.hpp"
#include "drive/power_state_machine.hpp"
#include "drive/profile_modes.hpp"
#include "drive/stepper_stage.hpp"
#include "drive/torque_mode.hpp"

namespace stator::drive {

struct AxisConfiguration {
  std::uint8_t number = 0;                      ///< 0 = first axis of the device
  std::uint16_t profile_offset = 0;             ///< added to the indices of CiA 402
  ErrorReactions reactions{};                   ///< by AxisError
  base::SimDuration control_period{1'000'000};  ///< between two calls of tick()
};

/// One CiA 402 stepper axis: power drive state machine, modes of operation, limits, supervision and
/// the way from the set-point to coil currents.
///
/// Writes of controlword, mode and targets are noted by hooks of the dictionary and act in apply(),
/// which the device calls when the bus has brought something: all objects of one process data frame
/// are in place then, whatever their order in it. tick() is the firmware loop, step() the hardware.
class Axis {
 public:
  /// Binds the axis to its objects. Throws std::logic_error if one is missing.
  Axis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
       base::EventReporter reporter);
  Axis(const Axis&) = delete;
  Axis& operator=(const Axis&) = delete;
  ~Axis() = default;

  /// To be brought up to date before apply() and tick().
  [[nodiscard]] AxisSettings& settings() { return settings_; }
  [[nodiscard]] const AxisSettings& settings() const { return settings_; }
  [[nodiscard]] AxisConditions& conditions() { return conditions_; }

  /// Something was written that apply() has not obeyed yet.
  [[nodiscard]] bool has_commands() const {
    return controlword_written_ || mode_written_ || target_written_;
  }
  /// Obeys what was written since the last call and updates the statusword.
  void apply(base::SimTime now);
  /// One control period: supervision, automatic transitions, actual values.
  void tick(base::SimTime now);
  /// Lets `duration` pass for ramp and driver; `sensing` is what the sensors told at its begin.
  base::AxisActuation step(base::SimDuration duration, const base::AxisSensing& sensing);

  /// Waits for the next index pulse of the encoder (not before 606Ah selects one), or no longer.
  void arm_index_latch(bool armed);
  struct LatchedPositions {
    std::int64_t demand = 0;   ///< 6062h at the index pulse, microsteps
    std::int64_t encoder = 0;  ///< 6064h by the encoder there, microsteps
  };
  /// What the latch holds, once.
  [[nodiscard]] std::optional<LatchedPositions> take_index_latch();

  /// The network has left its operational state: the motor stops, the drive is disabled.
  void network_left_operational(base::SimTime now);
  /// Takes the encoder's position as demand position if 606Ah and the settings say so.
  void initialise_position();

  [[nodiscard]] PowerState power_state() const { return power_.state(); }
  [[nodiscard]] bool bridge_enabled() const { return power_.bridge_enabled(); }
  /// The brake sequence wants the brake open.
  [[nodiscard]] bool brake_released() const { return power_.brake_released(); }
  [[nodiscard]] const AxisMotion& motion() const { return motion_; }
  [[nodiscard]] const DriverChip& driver() const { return driver_; }
  [[nodiscard]] const AxisObjects& objects() const { return objects_; }
  [[nodiscard]] ModeCode mode() const { return mode_->code(); }
  /// Errors that are present, and faults that were and wait for a fault reset.
  [[nodiscard]] AxisErrors errors() const { return errors_; }
  [[nodiscard]] std::uint32_t fault_resets() const { return power_.fault_resets(); }
  [[nodiscard]] std::int64_t actual_position() const;  ///< 6064h in 64 bits, microsteps
  [[nodiscard]] double actual_velocity() const;        ///< pps
  [[nodiscard]] std::uint64_t step_count() const { return stage_.step_count(); }
  [[nodiscard]] const control::ClosedLoopController& closed_loop() const {
    return stage_.closed_loop();
  }
  void set_commutation_offset(std::int32_t offset) { stage_.set_commutation_offset(offset); }

 private:
  void note_controlword(const dictionary::Entry& /*entry*/) { controlword_written_ = true; }
  void note_mode(const dictionary::Entry& /*entry*/) { mode_written_ = true; }
  void note_target(const dictionary::Entry& /*entry*/) { target_written_ = true; }

  [[nodiscard]] PowerInput power_input(base::SimTime now) const;
  [[nodiscard]] ModeContext context(base::SimTime now);
  [[nodiscard]] OperatingMode& mode_of(ModeCode code);
  void take_controlword(base::SimTime now);
  void take_mode(base::SimTime now);
  void follow_power_state(base::SimTime now);
  void follow_halt(base::SimTime now);
  void enter_mode(base::SimTime now);
  [[nodiscard]] bool halt_wanted() const;
  [[nodiscard]] ErrorReaction reaction_to(AxisError error) const;
  [[nodiscard]] bool is_fault(AxisError error) const;
  [[nodiscard]] bool fault_present() const;
  [[nodiscard]] bool warning_present() const;
  void supervise(base::SimTime now);
  void supervise_driver(base::SimTime now);
  void stop_on_stall();
  [[nodiscard]] bool stall_blocks() const;
  void watch(AxisError error, bool present, base::SimTime now);
  void update_feedback();
  void follow_limit_switches(const base::AxisSensing& sensing);
  void capture_positions(const base::AxisSensing& sensing);
  void supervise_closed_loop(base::SimTime now);
  void follow_rotor();
  void publish(base::SimTime now);
  void publish_statusword(base::SimTime now);

  AxisConfiguration configuration_;
  base::EventReporter reporter_;
  AxisObjects objects_;
  AxisSettings settings_;
  AxisConditions conditions_;

  PowerStateMachine power_;
  AxisMotion motion_;
  PositionFeedback feedback_;
  StepperStage stage_;
  PositionCapture homing_capture_;
  PositionCapture index_latch_;
  ClosedLoopConditions closed_loop_conditions_;
  bool closed_loop_wanted_ = false;  ///< and possible
  DriverChip driver_;

  NoMode no_mode_{ModeCode::none};
  ProfilePosition profile_position_;
  ProfileVelocity profile_velocity_;
  Homing homing_;
  CyclicPosition cyclic_position_;
  CyclicVelocity cyclic_velocity_;
  CyclicTorque cyclic_torque_;
  OperatingMode* mode_ = &no_mode_;

  bool controlword_written_ = false;
  bool mode_written_ = false;
  bool target_written_ = false;
  bool leaving_mode_ = false;      ///< the motor brakes for a change of mode
  std::uint16_t controlword_ = 0;  ///< as last obeyed
  bool enabled_ = false;           ///< as last told to the mode
  bool halted_ = false;
  bool stalled_ = false;             ///< stopped by a stall and not moved since
  Braking braking_ = Braking::none;  ///< as last told to the motion
  bool negative_direction_ = false;
  std::uint32_t fault_resets_ = 0;  ///< of the state machine, as last seen
  std::int64_t encoder_count_ = 0;
  bool left_switch_ = false;  ///< levels in the step before
  bool right_switch_ = false;
  std::array<double, 2> coil_current_{};
  AxisErrors fault_errors_;    ///< those that lead to Fault
  AxisErrors warning_errors_;  ///< those that set statusword bit 7
  AxisErrors causes_;          ///< present now
  AxisErrors errors_;          ///< present, and faults not yet reset
};

}  // namespace stator::drive
