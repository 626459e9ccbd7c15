#include "stator/tmcl/assembler/program_flow.hpp"

#include <vector>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

namespace {

using enum Command;

/// Whether the instruction behind it may come next.
bool continues(const Instruction& instruction) {
  const auto command = static_cast<Command>(instruction.command);
  return command != jump_always && command != return_from_subroutine && command != stop;
}

}  // namespace

std::optional<std::size_t> jump_target(const Instruction& instruction) {
  const auto command = static_cast<Command>(instruction.command);
  const bool jumps =
      command == jump_always || command == jump_conditionally || command == call_subroutine;
  return jumps && instruction.value >= 0
             ? std::optional(static_cast<std::size_t>(instruction.value))
             : std::nullopt;
}

bool can_run_past_end(std::span<const Instruction> program) {
  std::vector<bool> reached(program.size());
  std::vector<std::size_t> open{0};
  while (!open.empty()) {
    const std::size_t address = open.back();
    open.pop_back();
    if (address >= program.size() || reached[address]) {
      continue;
    }
    reached[address] = true;
    if (const auto target = jump_target(program[address])) {
      open.push_back(*target);
    }
    if (continues(program[address])) {
      open.push_back(address + 1);
    }
  }
  return !program.empty() && reached.back() && continues(program.back());
}

}  // namespace stator::tmcl
