#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace stator::manual {

/// What a person can have an axis do.
enum class CommandKind : std::uint8_t {
  enable,       ///< up to Operation enabled
  disable,      ///< down to Switch on disabled
  reset_fault,  ///< acknowledges a fault
  jog,          ///< turns at Command::value until kJogHold is over or another command comes
  move,         ///< to the position Command::value, or by it
  home,         ///< reference run by the device's own method
  stop,         ///< brakes, and stays enabled
  quick_stop,   ///< brakes as the drive's quick stop option code says
  mode,         ///< mode of operation Command::value (6060h)
  controlword,  ///< writes Command::value to 6040h as it is
};

/// The name that programs use, e.g. "quick-stop".
[[nodiscard]] std::string_view name_of(CommandKind kind);
/// Nothing: no command has that name.
[[nodiscard]] std::optional<CommandKind> command_of(std::string_view name);
/// All names.
[[nodiscard]] std::vector<std::string_view> command_names();

/// What objects and parameters of devices hold.
[[nodiscard]] constexpr bool is_integer32(std::int64_t value) {
  return value >= std::numeric_limits<std::int32_t>::min() &&
         value <= std::numeric_limits<std::int32_t>::max();
}

/// A command for an axis. Positions and velocities are in the units of the device.
struct Command {
  CommandKind kind = CommandKind::stop;
  std::int64_t value = 0;
  bool relative = false;                    ///< move: by `value` from where the axis is
  std::optional<std::uint32_t> velocity{};  ///< move: instead of the device's own
};

}  // namespace stator::manual
