#pragma once

#include <string>
#include <vector>

#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

/// Why a module will refuse an instruction of a program, and which of its fields is to blame.
struct Violation {
  Field field = Field::none;
  std::string message;
};

/// What `module` will refuse when it comes to `instruction`, a use of `declaration`: motors,
/// parameters, coordinates and ports it does not have, values out of their range, parameters that
/// can only be read or are not kept. Accelerations are not compared with their maximum, because the
/// unit is chosen while the program runs.
[[nodiscard]] std::vector<Violation> violations_of(const Instruction& instruction,
                                                   const CommandDeclaration& declaration,
                                                   const ModuleDescription& module);

}  // namespace stator::tmcl
