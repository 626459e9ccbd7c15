#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "tmcl/command_set.hpp"
#include "tmcl/parameter.hpp"

namespace stator::tmcl {

/// What is particular to a module for everything that reads and writes its programs and telegrams:
/// assembler, disassembler, shell, lists. A module's firmware is made from the same tables.
struct ModuleDescription {
  std::string_view product;  ///< e.g. "tmcm-142"
  CommandSet commands;
  std::span<const ParameterDeclaration> axis_parameters;
  std::span<const ParameterDeclaration> global_parameters;
  std::uint8_t axes = 1;
  std::size_t program_length = 2048;  ///< instructions its memory holds
  std::uint8_t coordinates = 21;      ///< from 0 on

  /// The declaration of a parameter; null if the module has none of that number.
  [[nodiscard]] const ParameterDeclaration* axis_parameter(std::uint8_t number) const;
  [[nodiscard]] const ParameterDeclaration* global_parameter(std::uint8_t bank,
                                                             std::uint8_t number) const;
};

}  // namespace stator::tmcl
