#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/tmcl/instruction.hpp"

namespace stator::tmcl {

/// A name for an address of a program.
struct Label {
  std::string name;
  std::size_t address = 0;
  std::size_t line = 0;  ///< of the text, from 1
};

/// A name for a number in the text of a program.
struct Constant {
  std::string name;
  std::int32_t value = 0;
  std::size_t line = 0;  ///< of the text, from 1
};

/// An assembled program: what a module's memory holds from address 0 on, and where it comes from.
struct Program {
  std::vector<Instruction> instructions;
  std::vector<std::size_t> lines;  ///< of the text, from 1; one for each instruction
  std::vector<Label> labels;       ///< in the order of the text
  std::vector<Constant> constants;
};

}  // namespace stator::tmcl
