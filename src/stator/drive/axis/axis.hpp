// An axis of CiA 402 without its power stage, the base of StepperAxis and ServoAxis, and its
// configuration.
#pragma once

#include <array>
#include <cstdint>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/axis/axis_error.hpp"
#include "stator/drive/modes/cyclic_modes.hpp"
#include "stator/drive/modes/homing_mode.hpp"
#include "stator/drive/modes/profile_modes.hpp"
#include "stator/drive/modes/torque_mode.hpp"
#include "stator/drive/motion/axis_motion.hpp"
#include "stator/drive/motion/axis_objects.hpp"
#include "stator/drive/motion/axis_settings.hpp"
#include "stator/drive/motion/position_capture.hpp"
#include "stator/drive/motion/position_feedback.hpp"
#include "stator/drive/power/power_state_machine.hpp"

namespace stator::drive {

struct AxisConfiguration {
  std::uint8_t number = 0;                      ///< 0 = first axis of the device
  std::uint16_t profile_offset = 0;             ///< added to the indices of CiA 402
  ErrorReactions reactions{};                   ///< by AxisError
  base::SimDuration control_period{1'000'000};  ///< between two calls of tick()
};

/// One CiA 402 axis without its power stage: power drive state machine, modes of operation, limits
/// and supervision. StepperAxis and ServoAxis add the way from the set-point to currents, as
/// final classes whose step() is called directly: nothing virtual happens more often than once
/// per control period.
///
/// Writes of controlword, mode and targets are noted by hooks of the dictionary and act in apply(),
/// which the device calls when the bus has brought something: all objects of one process data frame
/// are in place then, whatever their order in it. tick() is the firmware loop, step() of the
/// derived class the hardware.
class Axis {
 public:
  Axis(const Axis&) = delete;
  Axis& operator=(const Axis&) = delete;
  virtual ~Axis() = default;

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

  /// The network has left its operational state, or the bus is lost: the motor stops on the quick
  /// stop ramp, the drive is disabled.
  void network_left_operational(base::SimTime now);
  /// NMT Stopped: an axis in Operation enabled goes to Fault with the reaction of 605Eh, in other
  /// states nothing happens.
  void network_stopped(base::SimTime now);
  /// Takes the encoder's position as demand position if 606Ah and the settings say so.
  void initialise_position();

  [[nodiscard]] PowerState power_state() const { return power_.state(); }
  [[nodiscard]] bool bridge_enabled() const { return power_.bridge_enabled(); }
  /// The brake sequence wants the brake open.
  [[nodiscard]] bool brake_released() const { return power_.brake_released(); }
  [[nodiscard]] const AxisMotion& motion() const { return motion_; }
  [[nodiscard]] const AxisObjects& objects() const { return objects_; }
  [[nodiscard]] ModeCode mode() const { return mode_->code(); }
  /// A homing method runs.
  [[nodiscard]] bool homing() const { return mode_ == &homing_ && homing_.runs(); }
  /// How often home was found.
  [[nodiscard]] std::uint32_t homings() const { return homing_.completions(); }
  /// Errors that are present, and faults that were and wait for a fault reset.
  [[nodiscard]] AxisErrors errors() const { return errors_; }
  [[nodiscard]] std::uint32_t fault_resets() const { return power_.fault_resets(); }
  [[nodiscard]] std::int64_t actual_position() const;        ///< 6064h in 64 bits, increments
  [[nodiscard]] virtual double actual_velocity() const = 0;  ///< pps

 protected:
  /// Binds the axis to its objects. Throws std::logic_error if one is missing. A derived class
  /// calls start() at the end of its own constructor.
  Axis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
       base::EventReporter reporter);
  void start() { publish(base::SimTime()); }

  /// What the modes must know of the stage.
  struct StageStatus {
    bool ready = true;           ///< false: set-points wait until it has found its commutation
    bool closed_loop = false;    ///< the motor is commutated by its sensors
    bool position_loop = false;  ///< demand and actual position have one coordinate
    double current = 0.0;        ///< A, filtered, what homing on a hard stop looks at
  };

  /// Begin of a control period, before anything is obeyed: positions, state of the stage.
  virtual void begin_period(base::SimTime now) = 0;
  /// Watches what only this stage has.
  virtual void supervise_stage(base::SimTime now) = 0;
  /// Behind all that may have changed the set-point.
  virtual void end_period() {}
  [[nodiscard]] virtual StageStatus stage_status() const = 0;
  virtual void fault_was_reset() {}
  /// A, for 6077h.
  [[nodiscard]] virtual double torque_current() const = 0;
  /// Statusword bit 4.
  [[nodiscard]] virtual bool voltage_enabled() const = 0;
  /// pps; its sign and whether it is 0 are bits 14 and 15 of the statusword.
  [[nodiscard]] virtual double shown_velocity() const = 0;

  /// Takes `error` up when it appears: event, reaction, fault.
  void watch(AxisError error, bool present, base::SimTime now) {
    if (present != causes_.has(error) || (!present && errors_.has(error))) [[unlikely]] {
      take_up(error, present, now);
    }
  }
  /// watch() would have nothing to do, were it asked for each of `watched` and found `present` of
  /// them.
  [[nodiscard]] bool nothing_new(AxisErrors watched, AxisErrors present) const {
    return present == (causes_ & watched) && !errors_.without(causes_).any_of(watched);
  }
  /// As a motion controller chip does, the axis stops at a limit switch at once; what its firmware
  /// has to say comes with the next control period.
  void follow_limit_switches(const SwitchLevels& levels);
  [[nodiscard]] bool switches_changed(bool left, bool right) const {
    return left != left_switch_ || right != right_switch_;
  }
  [[nodiscard]] bool enabled() const { return enabled_; }
  [[nodiscard]] const OperatingMode& operating_mode() const { return *mode_; }
  [[nodiscard]] AxisErrors causes() const { return causes_; }
  [[nodiscard]] const AxisConfiguration& configuration() const { return configuration_; }

  base::EventReporter reporter_;
  AxisObjects objects_;
  AxisSettings settings_;
  AxisConditions conditions_;
  PowerStateMachine power_;
  AxisMotion motion_;
  PositionFeedback feedback_;
  PositionCapture homing_capture_;
  bool stalled_ = false;  ///< stopped by a stall and not moved since

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
  void enter_mode(base::SimTime now, bool behind_stop);
  [[nodiscard]] bool halt_wanted() const;
  [[nodiscard]] ErrorReaction reaction_to(AxisError error) const;
  [[nodiscard]] bool is_fault(AxisError error) const;
  [[nodiscard]] bool fault_present() const;
  [[nodiscard]] bool warning_present() const;
  void supervise(base::SimTime now);
  [[nodiscard]] bool following_error(std::int64_t deviation, base::SimTime now);
  void take_up(AxisError error, bool present, base::SimTime now);
  [[nodiscard]] bool stall_blocks() const;
  void publish(base::SimTime now);
  void publish_statusword(base::SimTime now);

  AxisConfiguration configuration_;
  NoMode no_mode_{ModeCode::none};
  ProfilePosition profile_position_;
  ProfileVelocity profile_velocity_;
  Homing homing_;
  CyclicPosition cyclic_position_;
  CyclicVelocity cyclic_velocity_;
  CyclicTorque cyclic_torque_;
  ProfileTorque profile_torque_;
  OperatingMode* mode_ = &no_mode_;

  bool controlword_written_ = false;
  bool mode_written_ = false;
  bool target_written_ = false;
  bool leaving_mode_ = false;      ///< the motor brakes for a change of mode
  std::uint16_t controlword_ = 0;  ///< as last obeyed
  bool enabled_ = false;           ///< as last told to the mode
  bool halted_ = false;
  Braking braking_ = Braking::none;  ///< as last told to the motion
  bool negative_direction_ = false;
  bool follows_badly_ = false;  ///< the deviation is above 6065h
  base::SimTime follows_badly_since_;
  std::uint32_t fault_resets_ = 0;  ///< of the state machine, as last seen
  bool left_switch_ = false;        ///< levels in the step before
  bool right_switch_ = false;
  AxisErrors fault_errors_;    ///< those that lead to Fault
  AxisErrors warning_errors_;  ///< those that set statusword bit 7
  AxisErrors causes_;          ///< present now
  AxisErrors errors_;          ///< present, and faults not yet reset
};

}  // namespace stator::drive
