#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl_tools {

/// What a module answered, in words: "MAX_CURRENT (axis parameter 6) = 8, current scale" after a
/// reading command, "refused: wrong type (status 3)", else "done".
[[nodiscard]] std::string answer_text(const tmcl::Instruction& instruction, tmcl::Status status,
                                      std::int32_t value, const tmcl::ModuleDescription& module);

/// Unit of a parameter's values, for people; empty if they have none.
[[nodiscard]] std::string_view unit_text(const tmcl::ParameterDeclaration& parameter);

}  // namespace stator::tmcl_tools
