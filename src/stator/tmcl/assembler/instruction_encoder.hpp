#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "stator/tmcl/assembler/diagnostic.hpp"
#include "stator/tmcl/assembler/lexer.hpp"
#include "stator/tmcl/assembler/name_table.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::tmcl {

/// Mnemonic for what no other can express: RAW command, type, motor, value.
inline constexpr std::string_view kRawMnemonic = "RAW";

/// Makes instructions of the lines of a program, once all its names are known.
class InstructionEncoder {
 public:
  /// All three have to outlive the encoder.
  InstructionEncoder(const ModuleDescription& module, const NameTable& names,
                     std::vector<Diagnostic>& diagnostics)
      : module_(module), names_(names), diagnostics_(diagnostics) {}

  /// The instruction of a line: `statement` begins with a mnemonic and ends with the end of the
  /// line. None after an error; errors and warnings go to the diagnostics.
  [[nodiscard]] std::optional<Instruction> encode(std::size_t line,
                                                  std::span<const Token> statement);

 private:
  using Operands = std::vector<std::span<const Token>>;

  /// The operands, each with what ends it; none if their number is wrong.
  [[nodiscard]] std::optional<Operands> operands_of(std::span<const Token> statement,
                                                    std::size_t count, std::string_view syntax);
  [[nodiscard]] std::optional<Instruction> encode_raw(std::span<const Token> statement);
  [[nodiscard]] std::optional<Instruction> encode_declared(const CommandDeclaration& declaration,
                                                           std::span<const Token> statement);
  [[nodiscard]] std::optional<std::int64_t> value_of(const Operand& operand,
                                                     const CommandDeclaration& declaration,
                                                     std::span<const Token> tokens);
  [[nodiscard]] std::optional<std::int64_t> symbol(const CommandDeclaration& declaration,
                                                   std::span<const Token> tokens);
  [[nodiscard]] std::optional<std::int64_t> expression(std::span<const Token> tokens,
                                                       const OperandScope& scope);
  [[nodiscard]] bool in_range(std::int64_t value, const Operand& operand, const Token& at);
  [[nodiscard]] bool in_range(std::int64_t value, std::int64_t least, std::int64_t most,
                              const Token& at, std::string_view what);
  [[nodiscard]] bool in_its_bank(const CommandDeclaration& declaration, const Operands& operands,
                                 const Instruction& instruction);
  void unknown_command(std::span<const Token> statement);
  void error(const Token& at, std::string message);

  const ModuleDescription& module_;
  const NameTable& names_;
  std::vector<Diagnostic>& diagnostics_;
  std::size_t line_ = 0;
};

}  // namespace stator::tmcl
