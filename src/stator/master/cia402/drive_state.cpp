#include "stator/master/cia402/drive_state.hpp"

#include <algorithm>
#include <array>

namespace stator::master {

namespace {

/// How a state shows in the statusword (CiA 402-2 table 29).
struct StatePattern {
  std::uint16_t mask;
  std::uint16_t value;
  DriveState state;
  std::string_view name;
};
constexpr std::array kStatePatterns{
    StatePattern{0x4F, 0x00, DriveState::not_ready_to_switch_on, "Not ready to switch on"},
    StatePattern{0x4F, 0x40, DriveState::switch_on_disabled, "Switch on disabled"},
    StatePattern{0x6F, 0x21, DriveState::ready_to_switch_on, "Ready to switch on"},
    StatePattern{0x6F, 0x23, DriveState::switched_on, "Switched on"},
    StatePattern{0x6F, 0x27, DriveState::operation_enabled, "Operation enabled"},
    StatePattern{0x6F, 0x07, DriveState::quick_stop_active, "Quick stop active"},
    StatePattern{0x4F, 0x0F, DriveState::fault_reaction_active, "Fault reaction active"},
    StatePattern{0x4F, 0x08, DriveState::fault, "Fault"},
};

}  // namespace

std::string_view to_text(DriveState state) {
  const auto* const found =
      std::find_if(kStatePatterns.begin(), kStatePatterns.end(),
                   [state](const StatePattern& pattern) { return pattern.state == state; });
  return found == kStatePatterns.end() ? "?" : found->name;
}

std::optional<DriveState> drive_state(std::uint16_t statusword) {
  for (const StatePattern& pattern : kStatePatterns) {
    if ((statusword & pattern.mask) == pattern.value) {
      return pattern.state;
    }
  }
  return std::nullopt;
}

}  // namespace stator::master
