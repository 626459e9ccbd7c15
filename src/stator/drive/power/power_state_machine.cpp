#include "stator/drive/power/power_state_machine.hpp"

#include "stator/drive/power/control_words.hpp"

namespace stator::drive {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;
using enum PowerState;

// {0} controlword, {1} command, {2} state, {3} what the state takes, {4} axis.
constexpr EventRule kCommandRefused{
    "pds-command-refused", Severity::refusal,
    "axis {4}: controlword {0:x4} refused: {1} is not possible in {2}; the drive takes {3}"};
constexpr EventRule kFaultResetRefused{
    "pds-fault-reset-refused", Severity::refusal,
    "axis {4}: controlword {0:x4} refused: {1} is not possible while the cause of the fault "
    "persists; remove the cause, then let bit 7 rise again"};
constexpr EventRule kOperationHeldBack{
    "pds-operation-held-back", Severity::refusal,
    "axis {4}: controlword {0:x4} held back: {1} needs the network in its operational state, the "
    "drive waits in {2}; bring the network to Operational"};

struct CommandPattern {
  PowerCommand command;
  std::uint16_t mask;
  std::uint16_t match;
};

// Bits 7, 3, 2, 1, 0 (CiA 402-2 table 28).
constexpr std::array kCommandPatterns{
    CommandPattern{PowerCommand::shutdown, 0x0087, 0x0006},
    CommandPattern{PowerCommand::switch_on, 0x008F, 0x0007},
    CommandPattern{PowerCommand::enable_operation, 0x008F, 0x000F},
    CommandPattern{PowerCommand::disable_voltage, 0x0082, 0x0000},
    CommandPattern{PowerCommand::quick_stop, 0x0086, 0x0002},
};

struct StateRow {
  PowerState state;
  std::uint16_t statusword;  ///< bits 0-3, 5, 6
  base::StaticText name;
  base::StaticText takes;  ///< commands that lead on, for the sentence of a refusal
};

// Bit 5 is 0 only while a quick stop is active; where the standard leaves it open it is 1.
constexpr std::array kStates{
    StateRow{not_ready_to_switch_on, 0x0020, "Not ready to switch on", "no command yet"},
    StateRow{switch_on_disabled, 0x0060, "Switch on disabled", "Shutdown (0006h)"},
    StateRow{ready_to_switch_on, 0x0021, "Ready to switch on", "Switch on (0007h)"},
    StateRow{switched_on, 0x0023, "Switched on", "Enable operation (000Fh)"},
    StateRow{operation_enabled, 0x0027, "Operation enabled", "every command"},
    StateRow{quick_stop_active, 0x0007, "Quick stop active",
             "Disable voltage (0000h), after 605Ah = 5 or 6 also Enable operation (000Fh)"},
    StateRow{fault_reaction_active, 0x002F, "Fault reaction active",
             "commands again when the motor has stopped"},
    StateRow{fault, 0x0028, "Fault", "Fault reset (a rising edge of bit 7)"},
};

constexpr const StateRow& row_of(PowerState state) {
  return kStates[static_cast<std::size_t>(state)];
}

const PowerTransition* find_transition(PowerState from, PowerCommand command) {
  for (const PowerTransition& transition : kPowerTransitions) {
    if (transition.from == from && transition.command == command) {
      return &transition;
    }
  }
  return nullptr;
}

/// The command asks for nothing that is not so already, or for less than the state gives.
bool is_satisfied(PowerState state, PowerCommand command) {
  switch (command) {
    case PowerCommand::none:
    case PowerCommand::fault_reset:
      return true;
    case PowerCommand::shutdown:
      return state == ready_to_switch_on;
    case PowerCommand::switch_on:
      return state == switched_on;
    case PowerCommand::enable_operation:
      return state == operation_enabled;
    case PowerCommand::disable_voltage:
    case PowerCommand::quick_stop:
      return true;
  }
  return true;
}

Braking braking_by(int option) {
  switch (option) {
    case 0:
      return Braking::at_once;
    case 1:
    case 5:
      return Braking::slow_down_ramp;
    default:
      return Braking::quick_stop_ramp;
  }
}

}  // namespace

base::StaticText to_text(PowerState state) {
  return row_of(state).name;
}

std::uint16_t statusword_of(PowerState state) {
  return row_of(state).statusword;
}

PowerCommand command_of(std::uint16_t controlword) {
  for (const CommandPattern& pattern : kCommandPatterns) {
    if ((controlword & pattern.mask) == pattern.match) {
      return pattern.command;
    }
  }
  return PowerCommand::none;
}

base::StaticText to_text(PowerCommand command) {
  switch (command) {
    case PowerCommand::none:
      return "no command";
    case PowerCommand::shutdown:
      return "Shutdown";
    case PowerCommand::switch_on:
      return "Switch on";
    case PowerCommand::enable_operation:
      return "Enable operation";
    case PowerCommand::disable_voltage:
      return "Disable voltage";
    case PowerCommand::quick_stop:
      return "Quick stop";
    case PowerCommand::fault_reset:
      return "Fault reset";
  }
  return "?";
}

void PowerStateMachine::command(std::uint16_t controlword, const PowerInput& input) {
  const bool reset_edge = (controlword & ~controlword_ & controlword::kFaultReset) != 0;
  controlword_ = controlword;
  progress(input);
  if (reset_edge && state_ == fault) {
    reset_fault(input);
    return;
  }
  const PowerCommand command = command_of(controlword);
  if (phase_ == Phase::settled && !is_satisfied(state_, command)) {
    explain_refusal(controlword, command, input);
  }
}

void PowerStateMachine::update(const PowerInput& input) {
  if (state_ == not_ready_to_switch_on) {
    state_ = switch_on_disabled;  // transition 1: nothing to initialise
  }
  progress(input);
}

void PowerStateMachine::progress(const PowerInput& input) {
  progress_phase(input);
  follow_command(input);
}

void PowerStateMachine::follow_command(const PowerInput& input) {
  const PowerCommand command = command_of(controlword_);
  if (phase_ == Phase::braking && state_ == operation_enabled &&
      (command == PowerCommand::disable_voltage || command == PowerCommand::quick_stop)) {
    phase_ = Phase::settled;  // neither waits for the ramp of another transition
  }
  while (phase_ == Phase::settled) {
    const PowerTransition* transition = find_transition(state_, command);
    if (transition == nullptr || !permitted(*transition, input)) {
      return;
    }
    execute(*transition, input);
  }
}

bool PowerStateMachine::permitted(const PowerTransition& transition,
                                  const PowerInput& input) const {
  switch (transition.number) {
    case 4:
      return input.operation_permitted;
    case 16:
      return input.operation_permitted && !quick_stop_ends_;
    default:
      return true;
  }
}

void PowerStateMachine::execute(const PowerTransition& transition, const PowerInput& input) {
  switch (transition.number) {
    case 4:
      bridge_enabled_ = true;
      goal_ = transition.to;
      phase_ = Phase::building_hold_current;
      phase_end_ = input.now + input.delays.hold_current;
      progress_phase(input);
      break;
    case 5:
      leave_by_ramp(braking_by(input.options.disable_operation), transition.to, input);
      break;
    case 8:
      leave_by_ramp(braking_by(input.options.shutdown), transition.to, input);
      break;
    case 11:
      if (input.options.quick_stop == 0) {
        stop_and_disable(switch_on_disabled, input);
        break;
      }
      state_ = transition.to;
      braking_ = braking_by(input.options.quick_stop);
      quick_stop_ends_ = input.options.quick_stop < 5;
      break;
    case 16:
      state_ = transition.to;
      braking_ = Braking::none;
      break;
    case 9:
    case 10:
    case 12:
      stop_and_disable(transition.to, input);
      break;
    default:
      state_ = transition.to;
      break;
  }
}

void PowerStateMachine::progress_phase(const PowerInput& input) {
  if (phase_ == Phase::building_hold_current && input.now >= phase_end_) {
    brake_released_ = true;
    phase_ = Phase::releasing_brake;
    phase_end_ = phase_end_ + input.delays.brake_release;
  }
  if (phase_ == Phase::releasing_brake && input.now >= phase_end_) {
    phase_ = Phase::settled;
    state_ = goal_;
    braking_ = Braking::none;
  }
  if (phase_ == Phase::braking && input.at_rest) {
    disable_bridge(goal_, input);
  }
  if (phase_ == Phase::applying_brake && input.now >= phase_end_) {
    disable_bridge_at_once(goal_);
  }
  if (phase_ == Phase::settled && input.at_rest) {
    if (state_ == quick_stop_active && quick_stop_ends_) {
      disable_bridge(switch_on_disabled, input);  // transition 12
    } else if (state_ == fault_reaction_active) {
      disable_bridge(fault, input);  // transition 14
    }
  }
}

void PowerStateMachine::leave_by_ramp(Braking braking, PowerState goal, const PowerInput& input) {
  if (braking == Braking::at_once) {
    stop_and_disable(goal, input);
    return;
  }
  braking_ = braking;
  goal_ = goal;
  phase_ = Phase::braking;
  progress_phase(input);
}

void PowerStateMachine::stop_and_disable(PowerState goal, const PowerInput& input) {
  braking_ = Braking::at_once;
  disable_bridge(goal, input);
}

void PowerStateMachine::disable_bridge(PowerState goal, const PowerInput& input) {
  goal_ = goal;
  brake_released_ = false;
  phase_ = Phase::applying_brake;
  phase_end_ = bridge_enabled_ ? input.now + input.delays.brake_apply : base::SimTime(input.now);
  if (input.now >= phase_end_) {
    disable_bridge_at_once(goal);
  }
}

void PowerStateMachine::disable_bridge_at_once(PowerState next) {
  state_ = next;
  phase_ = Phase::settled;
  braking_ = Braking::at_once;
  bridge_enabled_ = false;
  brake_released_ = false;
}

void PowerStateMachine::raise_fault(const PowerInput& input, bool power_off) {
  if (state_ == fault || (state_ == fault_reaction_active && !power_off)) {
    return;
  }
  state_ = fault_reaction_active;
  phase_ = Phase::settled;
  if (power_off || !bridge_enabled_) {
    disable_bridge_at_once(fault_reaction_active);
    return;
  }
  if (input.options.fault_reaction == 0) {
    stop_and_disable(fault, input);
    return;
  }
  braking_ = braking_by(input.options.fault_reaction);
}

void PowerStateMachine::network_left_operational(const PowerInput& input) {
  if (state_ == fault || state_ == fault_reaction_active) {
    return;
  }
  if (state_ == operation_enabled || state_ == quick_stop_active) {
    state_ = quick_stop_active;
    phase_ = Phase::settled;
    braking_ = Braking::quick_stop_ramp;
    quick_stop_ends_ = true;
    progress_phase(input);
    return;
  }
  stop_and_disable(switch_on_disabled, input);
}

void PowerStateMachine::reset_fault(const PowerInput& input) {
  if (input.fault_present) {
    reporter_.report(input.now, kFaultResetRefused,
                     {EventArgument(int{controlword_}),
                      to_text(PowerCommand::fault_reset),
                      EventArgument(to_text(state_)),
                      {},
                      EventArgument(int{axis_})});
    return;
  }
  state_ = switch_on_disabled;
  ++fault_resets_;
}

void PowerStateMachine::explain_refusal(std::uint16_t controlword, PowerCommand command,
                                        const PowerInput& input) const {
  const bool held_back = state_ == switched_on && command == PowerCommand::enable_operation;
  reporter_.report(
      input.now, held_back ? kOperationHeldBack : kCommandRefused,
      {EventArgument(int{controlword}), to_text(command), EventArgument(row_of(state_).name),
       EventArgument(row_of(state_).takes), EventArgument(int{axis_})});
}

}  // namespace stator::drive
