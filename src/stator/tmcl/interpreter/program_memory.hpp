#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/tmcl/instruction.hpp"

namespace stator::tmcl {

/// The memory of programs: one cell for each instruction, kept without power. An erased cell holds
/// command 0 (A62).
class ProgramMemory {
 public:
  /// Allocates; nothing else here does.
  explicit ProgramMemory(std::size_t length) : cells_(length) {}

  [[nodiscard]] std::size_t size() const { return cells_.size(); }
  [[nodiscard]] bool contains(std::int64_t address) const {
    return address >= 0 && address < static_cast<std::int64_t>(cells_.size());
  }
  /// `address` must be within the memory.
  [[nodiscard]] const Instruction& operator[](std::size_t address) const { return cells_[address]; }
  [[nodiscard]] std::span<const Instruction> cells() const { return cells_; }

  /// `address` must be within the memory.
  void write(std::size_t address, const Instruction& instruction);
  void erase();
  /// Puts `program` to the begin of the memory and erases the rest; what is too long is cut.
  void load(std::span<const Instruction> program);
  /// Rises with every change, for those who keep the memory without power.
  [[nodiscard]] std::uint64_t write_count() const { return writes_; }

 private:
  std::vector<Instruction> cells_;
  std::uint64_t writes_ = 0;
};

}  // namespace stator::tmcl
