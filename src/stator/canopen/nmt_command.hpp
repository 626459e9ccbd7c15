#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/canopen/nmt_state.hpp"

namespace stator::canopen {

/// Identifiers of the predefined connection set (CiA 301 §7.3.5) that the node itself knows; those
/// of error control contain the node-ID.
inline constexpr std::uint32_t kNmtIdentifier = 0x000;
inline constexpr std::uint32_t kErrorControlBase = 0x700;

/// Command specifiers of the NMT node control service (CiA 301 §7.2.8.3.1).
enum class NmtCommand : std::uint8_t {
  start = 1,
  stop = 2,
  enter_pre_operational = 128,
  reset_node = 129,
  reset_communication = 130,
};

/// What a command leads to. From every state but Initialisation the same.
struct NmtTransition {
  NmtCommand command;
  NmtState target;
};

inline constexpr std::array<NmtTransition, 5> kNmtTransitions{{
    {NmtCommand::start, NmtState::operational},
    {NmtCommand::stop, NmtState::stopped},
    {NmtCommand::enter_pre_operational, NmtState::pre_operational},
    {NmtCommand::reset_node, NmtState::initialisation},
    {NmtCommand::reset_communication, NmtState::initialisation},
}};

/// The transition that the command byte `command` asks for; nothing if there is no such command.
[[nodiscard]] constexpr std::optional<NmtTransition> find_transition(std::uint8_t command) {
  for (const NmtTransition& transition : kNmtTransitions) {
    if (static_cast<std::uint8_t>(transition.command) == command) {
      return transition;
    }
  }
  return std::nullopt;
}

}  // namespace stator::canopen
