#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"

namespace stator::drive {

/// States of the power drive system (CiA 402-2 §8.3).
enum class PowerState : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

/// The standard's name, e.g. "Switch on disabled".
[[nodiscard]] base::StaticText to_text(PowerState state);

/// Bits 0-3, 5 and 6 of the statusword as they code `state`.
[[nodiscard]] std::uint16_t statusword_of(PowerState state);

/// What bits 0-3 and 7 of the controlword command. The same pattern means Switch on and Disable
/// operation, and Enable operation and Switch on + enable operation; the present state decides.
enum class PowerCommand : std::uint8_t {
  none,  ///< bit 7 is set, no pattern fits
  shutdown,
  switch_on,  ///< or Disable operation
  enable_operation,
  disable_voltage,
  quick_stop,
  fault_reset,  ///< the rising edge of bit 7, not a pattern
};

/// The command that the pattern of `controlword` gives, never fault_reset.
[[nodiscard]] PowerCommand command_of(std::uint16_t controlword);
[[nodiscard]] base::StaticText to_text(PowerCommand command);

/// A transition that the master commands, with the number the standard gives it.
struct PowerTransition {
  std::uint8_t number;
  PowerState from;
  PowerState to;
  PowerCommand command;
};

/// All commanded transitions. 0 and 1 (start), 12 after a quick stop, 13 (fault) and 14 (fault
/// reaction finished) happen by themselves.
inline constexpr std::array kPowerTransitions{
    PowerTransition{2, PowerState::switch_on_disabled, PowerState::ready_to_switch_on,
                    PowerCommand::shutdown},
    PowerTransition{3, PowerState::ready_to_switch_on, PowerState::switched_on,
                    PowerCommand::switch_on},
    PowerTransition{3, PowerState::ready_to_switch_on, PowerState::switched_on,
                    PowerCommand::enable_operation},
    PowerTransition{4, PowerState::switched_on, PowerState::operation_enabled,
                    PowerCommand::enable_operation},
    PowerTransition{5, PowerState::operation_enabled, PowerState::switched_on,
                    PowerCommand::switch_on},
    PowerTransition{6, PowerState::switched_on, PowerState::ready_to_switch_on,
                    PowerCommand::shutdown},
    PowerTransition{7, PowerState::ready_to_switch_on, PowerState::switch_on_disabled,
                    PowerCommand::disable_voltage},
    PowerTransition{7, PowerState::ready_to_switch_on, PowerState::switch_on_disabled,
                    PowerCommand::quick_stop},
    PowerTransition{8, PowerState::operation_enabled, PowerState::ready_to_switch_on,
                    PowerCommand::shutdown},
    PowerTransition{9, PowerState::operation_enabled, PowerState::switch_on_disabled,
                    PowerCommand::disable_voltage},
    PowerTransition{10, PowerState::switched_on, PowerState::switch_on_disabled,
                    PowerCommand::disable_voltage},
    PowerTransition{10, PowerState::switched_on, PowerState::switch_on_disabled,
                    PowerCommand::quick_stop},
    PowerTransition{11, PowerState::operation_enabled, PowerState::quick_stop_active,
                    PowerCommand::quick_stop},
    PowerTransition{12, PowerState::quick_stop_active, PowerState::switch_on_disabled,
                    PowerCommand::disable_voltage},
    PowerTransition{15, PowerState::fault, PowerState::switch_on_disabled,
                    PowerCommand::fault_reset},
    PowerTransition{16, PowerState::quick_stop_active, PowerState::operation_enabled,
                    PowerCommand::enable_operation},
};

/// How the motor is to be brought to rest.
enum class Braking : std::uint8_t { none, slow_down_ramp, quick_stop_ramp, at_once };

/// Option codes 605Ah to 605Eh as far as they concern the state machine: 0 disables the drive
/// function at once, 1 takes the slow-down ramp, 2 the quick-stop ramp; 605Ah 5 and 6 are 1 and 2
/// and stay in Quick stop active.
struct PowerOptions {
  int quick_stop = 2;         ///< 605Ah
  int shutdown = 0;           ///< 605Bh
  int disable_operation = 1;  ///< 605Ch
  int fault_reaction = 2;     ///< 605Eh
};

/// Waiting times of the brake sequence; all zero: state changes follow at once. Whatever disables a
/// bridge that is on keeps to it, with a ramp before or without one; only a fault that takes the
/// power away applies the brake and switches the bridge off in the same moment.
struct PowerDelays {
  base::SimDuration hold_current;   ///< bridge on until the brake is released
  base::SimDuration brake_release;  ///< brake released until Operation enabled
  base::SimDuration brake_apply;    ///< brake applied until the bridge goes off
};

/// What the machine looks at whenever it runs.
struct PowerInput {
  base::SimTime now;
  bool operation_permitted = false;  ///< the network is in its operational state
  bool at_rest = true;               ///< the motor stands, or no current could brake it
  bool fault_present = false;        ///< the cause of a fault persists: no fault reset
  PowerOptions options;
  PowerDelays delays;
};

/// The power drive state machine of one axis (CiA 402-2 §8.3).
///
/// Commands are levels: a pattern that could not act yet (bridge building up current, motor braking
/// for Disable operation, network not yet operational) acts as soon as it can. A transition that
/// takes time is executed completely before the next command is looked at; a fault interrupts it,
/// and so do Disable voltage and Quick stop while the motor brakes.
class PowerStateMachine {
 public:
  PowerStateMachine(base::EventReporter reporter, std::uint8_t axis)
      : reporter_(reporter), axis_(axis) {}

  /// Takes a controlword that was written. Raises an event if the command cannot be obeyed.
  void command(std::uint16_t controlword, const PowerInput& input);
  /// Lets time work: automatic transitions, delays, commands held back. Call every control period.
  void update(const PowerInput& input);

  /// Transition 13. `power_off`: no ramp, the bridge goes off at once.
  void raise_fault(const PowerInput& input, bool power_off = false);
  /// The network has left its operational state: stops on the quick-stop ramp and goes to Switch on
  /// disabled; a drive that was not running goes there at once.
  void network_left_operational(const PowerInput& input);

  [[nodiscard]] PowerState state() const { return state_; }
  /// Set-points are obeyed: Operation enabled, and not on the way out of it.
  [[nodiscard]] bool drive_function_enabled() const {
    return state_ == PowerState::operation_enabled && phase_ == Phase::settled;
  }
  [[nodiscard]] bool bridge_enabled() const { return bridge_enabled_; }
  [[nodiscard]] bool brake_released() const { return brake_released_; }
  /// What the set-point generator has to do now; none while set-points are obeyed.
  [[nodiscard]] Braking braking() const { return braking_; }
  /// How often transition 15 has been made.
  [[nodiscard]] std::uint32_t fault_resets() const { return fault_resets_; }

 private:
  /// Where a transition that takes time stands.
  enum class Phase : std::uint8_t {
    settled,
    building_hold_current,  ///< 4: bridge on, brake still closed
    releasing_brake,        ///< 4: brake released, not yet enabled
    braking,                ///< 5, 8: motor on its ramp
    applying_brake,         ///< brake applied, bridge still on
  };

  void follow_command(const PowerInput& input);
  void execute(const PowerTransition& transition, const PowerInput& input);
  void progress(const PowerInput& input);
  void progress_phase(const PowerInput& input);
  void reset_fault(const PowerInput& input);
  void leave_by_ramp(Braking braking, PowerState goal, const PowerInput& input);
  /// The motion stops without a ramp, then disable_bridge().
  void stop_and_disable(PowerState goal, const PowerInput& input);
  /// Applies the brake, waits for it, switches the bridge off and goes to `goal`.
  void disable_bridge(PowerState goal, const PowerInput& input);
  void disable_bridge_at_once(PowerState next);
  [[nodiscard]] bool permitted(const PowerTransition& transition, const PowerInput& input) const;
  void explain_refusal(std::uint16_t controlword, PowerCommand command,
                       const PowerInput& input) const;

  base::EventReporter reporter_;
  std::uint8_t axis_ = 0;

  PowerState state_ = PowerState::not_ready_to_switch_on;
  Phase phase_ = Phase::settled;
  PowerState goal_ = PowerState::not_ready_to_switch_on;  ///< state after the phases under way
  base::SimTime phase_end_;
  Braking braking_ = Braking::none;
  bool quick_stop_ends_ = true;  ///< Quick stop active is left by transition 12 after the stop
  bool bridge_enabled_ = false;
  bool brake_released_ = false;
  std::uint16_t controlword_ = 0;
  std::uint32_t fault_resets_ = 0;
};

}  // namespace stator::drive
