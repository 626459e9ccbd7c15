#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

// A module's tables as text for people and files, row by row in the order of the declarations they
// are made of.

inline constexpr std::array<std::string_view, 9> kAxisParameterColumns{
    "number", "name", "access", "range", "default", "unit", "stored", "source_line", "notes"};
/// Access is R, RW, or RWE of what is kept in the EEPROM.
[[nodiscard]] std::vector<std::array<std::string, kAxisParameterColumns.size()>>
list_axis_parameters(const ModuleDescription& module);

inline constexpr std::array<std::string_view, 10> kGlobalParameterColumns{
    "bank",    "number", "name",   "access",      "range",
    "default", "unit",   "stored", "source_line", "notes"};
[[nodiscard]] std::vector<std::array<std::string, kGlobalParameterColumns.size()>>
list_global_parameters(const ModuleDescription& module);

inline constexpr std::array<std::string_view, 8> kCommandColumns{
    "number", "mnemonic", "type", "motor_bank", "value", "reply", "source_line", "notes"};
/// A command with an operation ("MVP ABS") has a row for each.
[[nodiscard]] std::vector<std::array<std::string, kCommandColumns.size()>> list_commands(
    const ModuleDescription& module);

/// What the values of a parameter count, e.g. "usteps", "flag", "1/256".
[[nodiscard]] std::string_view unit_of(const ParameterDeclaration& parameter);

}  // namespace stator::tmcl
