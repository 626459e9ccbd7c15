// States and automatic transitions of the power drive state machine (CiA 402-2 §8.3) and names of
// modes, for texts.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "stator/drive/power/power_state_machine.hpp"

namespace stator::drive {

inline constexpr std::array kPowerStates{
    PowerState::not_ready_to_switch_on, PowerState::switch_on_disabled,
    PowerState::ready_to_switch_on,     PowerState::switched_on,
    PowerState::operation_enabled,      PowerState::quick_stop_active,
    PowerState::fault_reaction_active,  PowerState::fault};

/// The state that a statusword shows; nothing for a pattern the standard does not define.
[[nodiscard]] std::optional<PowerState> power_state_of(std::uint16_t statusword);

/// A transition that the drive makes by itself (CiA 402-2 §8.3). PowerStateMachine makes it where
/// its cause is seen; kPowerTransitions has the commanded ones.
struct AutomaticPowerTransition {
  std::uint8_t number;
  std::optional<PowerState> from;  ///< nothing: from every state but those of faults; start for 0
  PowerState to;
  std::string_view cause;
};

inline constexpr std::array<AutomaticPowerTransition, 5> kAutomaticPowerTransitions{{
    {0, std::nullopt, PowerState::not_ready_to_switch_on, "start"},
    {1, PowerState::not_ready_to_switch_on, PowerState::switch_on_disabled,
     "initialisation finished"},
    {12, PowerState::quick_stop_active, PowerState::switch_on_disabled, "quick stop completed"},
    {13, std::nullopt, PowerState::fault_reaction_active, "fault"},
    {14, PowerState::fault_reaction_active, PowerState::fault, "fault reaction completed"},
}};

/// The standard's name of a mode of operation by its code in 6060h and 6061h, e.g. "cyclic
/// synchronous position"; "manufacturer specific" for negative ones, "reserved" for the rest.
[[nodiscard]] std::string_view mode_name(std::int8_t code);

}  // namespace stator::drive
