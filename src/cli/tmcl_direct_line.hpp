#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "base/expected.hpp"
#include "tmcl/instruction.hpp"
#include "tmcl/module_description.hpp"
#include "tmcl/telegram.hpp"

namespace stator::cli {

/// The command that a line asks for, as programs write it: "SAP MAX_CURRENT, 0, 8". Without commas
/// operands are separated by spaces: "sap 6 0 8". Else a sentence with what was expected. What the
/// module would refuse is a command all the same: that is its business.
[[nodiscard]] base::Expected<tmcl::Instruction, std::string> parse_direct_line(
    std::string_view line, const tmcl::ModuleDescription& module);

/// What a module answered, in words: "MAX_CURRENT (axis parameter 6) = 8, current scale" after a
/// reading command, "refused: wrong type (status 3)", else "done".
[[nodiscard]] std::string answer_text(const tmcl::Instruction& instruction, tmcl::Status status,
                                      std::int32_t value, const tmcl::ModuleDescription& module);

/// Unit of a parameter's values, for people; empty if they have none.
[[nodiscard]] std::string_view unit_text(const tmcl::ParameterDeclaration& parameter);

}  // namespace stator::cli
