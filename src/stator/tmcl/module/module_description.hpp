#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "stator/tmcl/command_set.hpp"
#include "stator/tmcl/module/parameter.hpp"

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

  std::string_view version_text{};  ///< eight characters, e.g. "142V4.45"
  std::int32_t version_value = 0;   ///< as command 136 gives it in binary form

  std::uint32_t digital_inputs = 0;  ///< bit n: input n exists
  std::uint32_t analog_inputs = 0;   ///< bit n: channel n exists
  std::uint32_t outputs = 0;         ///< bit n: output n exists
  /// The bits of reading all digital inputs at once: modules differ in whether inputs beyond the
  /// eighth show (A72).
  std::uint32_t input_bits = 0xFFFF'FFFF;

  /// The declaration of a parameter; null if the module has none of that number.
  [[nodiscard]] const ParameterDeclaration* axis_parameter(std::uint8_t number) const;
  [[nodiscard]] const ParameterDeclaration* global_parameter(std::uint8_t bank,
                                                             std::uint8_t number) const;
};

}  // namespace stator::tmcl
