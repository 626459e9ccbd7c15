#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "stator/tmcl/instruction.hpp"

namespace stator::tmcl {

/// The address to which an instruction may jump; none if it does not jump or if its value is
/// negative.
[[nodiscard]] std::optional<std::size_t> jump_target(const Instruction& instruction);

/// Whether a program that starts at address 0 can run on behind its last instruction, into what the
/// memory holds there. Conditions are taken to hold or not, subroutines to return; jumps to behind
/// the end do not count.
[[nodiscard]] bool can_run_past_end(std::span<const Instruction> program);

}  // namespace stator::tmcl
