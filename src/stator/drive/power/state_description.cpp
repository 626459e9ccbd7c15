#include "stator/drive/power/state_description.hpp"

namespace stator::drive {

namespace {

/// Bits 0-3, 5 and 6; bit 5 says nothing in the states below Ready to switch on and of faults.
constexpr std::uint16_t kAllBits = 0x006F;
constexpr std::uint16_t kWithoutQuickStop = 0x004F;

}  // namespace

std::optional<PowerState> power_state_of(std::uint16_t statusword) {
  for (const PowerState state : kPowerStates) {
    const bool fault_or_below =
        state == PowerState::not_ready_to_switch_on || state == PowerState::switch_on_disabled ||
        state == PowerState::fault_reaction_active || state == PowerState::fault;
    const std::uint16_t mask = fault_or_below ? kWithoutQuickStop : kAllBits;
    if ((statusword & mask) == (statusword_of(state) & mask)) {
      return state;
    }
  }
  return std::nullopt;
}

std::string_view mode_name(std::int8_t code) {
  switch (code) {
    case 0:
      return "no mode";
    case 1:
      return "profile position";
    case 2:
      return "velocity";
    case 3:
      return "profile velocity";
    case 4:
      return "profile torque";
    case 6:
      return "homing";
    case 7:
      return "interpolated position";
    case 8:
      return "cyclic synchronous position";
    case 9:
      return "cyclic synchronous velocity";
    case 10:
      return "cyclic synchronous torque";
    default:
      return code < 0 ? "manufacturer specific" : "reserved";
  }
}

}  // namespace stator::drive
