#include "stator/tmcl/interpreter/program_memory.hpp"

#include <algorithm>

namespace stator::tmcl {

void ProgramMemory::write(std::size_t address, const Instruction& instruction) {
  cells_[address] = instruction;
  ++writes_;
}

void ProgramMemory::erase() {
  std::ranges::fill(cells_, Instruction{});
  ++writes_;
}

void ProgramMemory::load(std::span<const Instruction> program) {
  erase();
  std::ranges::copy(program.first(std::min(program.size(), cells_.size())), cells_.begin());
}

}  // namespace stator::tmcl
