#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace stator::master {

/// States of the power drive system (CiA 402-2 §6.1).
enum class DriveState : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

/// The standard's name, e.g. "Operation enabled".
[[nodiscard]] std::string_view to_text(DriveState state);

/// The state that a statusword shows; nothing for a pattern the standard does not define.
[[nodiscard]] std::optional<DriveState> drive_state(std::uint16_t statusword);

}  // namespace stator::master
