#pragma once

#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

/// The command that a line asks for, as programs write it: "SAP MAX_CURRENT, 0, 8". Without commas
/// operands are separated by spaces: "sap 6 0 8". Else a sentence with what was expected. What the
/// module would refuse is a command all the same: that is its business.
[[nodiscard]] base::Expected<Instruction, std::string> parse_direct_line(
    std::string_view line, const ModuleDescription& module);

}  // namespace stator::tmcl
