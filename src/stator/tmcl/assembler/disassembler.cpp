#include "stator/tmcl/assembler/disassembler.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "stator/tmcl/assembler/instruction_encoder.hpp"
#include "stator/tmcl/assembler/program_flow.hpp"

namespace stator::tmcl {

namespace {

/// Where mnemonics begin, behind labels of up to "Sub2047: ".
constexpr std::size_t kMnemonicColumn = 9;

enum class Target : std::uint8_t { none, jump, subroutine };

std::int64_t field_of(const Instruction& instruction, Field field) {
  return field == Field::type    ? instruction.type
         : field == Field::motor ? instruction.motor
         : field == Field::value ? std::int64_t{instruction.value}
                                 : 0;
}

/// The instruction as its mnemonic expresses it: fields without an operand are 0.
Instruction expressed(const Instruction& instruction, const CommandDeclaration& declaration) {
  Instruction result{.command = instruction.command};
  for (const Operand& operand : declaration.operands) {
    if (operand.field == Field::type) {
      result.type = instruction.type;
    } else if (operand.field == Field::motor) {
      result.motor = instruction.motor;
    } else if (operand.field == Field::value) {
      result.value = instruction.value;
    }
  }
  return result;
}

class Disassembler {
 public:
  Disassembler(std::span<const Instruction> program, const ModuleDescription& module,
               const DisassemblyOptions& options)
      : program_(program), module_(module), options_(options), targets_(program.size() + 1) {
    for (const Instruction& instruction : program_) {
      const auto target = jump_target(instruction);
      if (target && *target < targets_.size() && mnemonic_form(instruction)) {
        const bool call = static_cast<Command>(instruction.command) == Command::call_subroutine;
        targets_[*target] = call ? Target::subroutine : std::max(targets_[*target], Target::jump);
      }
    }
  }

  [[nodiscard]] std::string text() const {
    std::string text;
    for (std::size_t address = 0; address < program_.size(); ++address) {
      text += beginning(address) + command(program_[address]) + '\n';
    }
    if (targets_.back() != Target::none) {
      text += label(program_.size()) + ":\n";
    }
    return text;
  }

 private:
  [[nodiscard]] std::string beginning(std::size_t address) const {
    std::string text = targets_[address] == Target::none ? "" : label(address) + ": ";
    text.resize(std::max(text.size(), kMnemonicColumn), ' ');
    return text;
  }

  [[nodiscard]] std::string label(std::size_t address) const {
    return (targets_[address] == Target::subroutine ? "Sub" : "L") + std::to_string(address);
  }

  [[nodiscard]] std::string command(const Instruction& instruction) const {
    if (const CommandDeclaration* declaration = mnemonic_form(instruction)) {
      std::string text(declaration->mnemonic);
      for (std::size_t i = 0; i < declaration->operand_count(); ++i) {
        text += i == 0 ? " " : ", ";
        text += operand(instruction, *declaration, declaration->operands[i]);
      }
      return text;
    }
    return std::string(kRawMnemonic) + ' ' + std::to_string(instruction.command) + ", " +
           std::to_string(instruction.type) + ", " + std::to_string(instruction.motor) + ", " +
           std::to_string(instruction.value);
  }

  /// Null if no mnemonic expresses the instruction.
  [[nodiscard]] const CommandDeclaration* mnemonic_form(const Instruction& instruction) const {
    const CommandDeclaration* declaration = module_.commands.find(instruction.command);
    if (declaration == nullptr || declaration->mnemonic.empty() || !declaration->use.program ||
        expressed(instruction, *declaration) != instruction) {
      return nullptr;
    }
    for (const Operand& operand : declaration->operands) {
      const std::int64_t value = field_of(instruction, operand.field);
      const bool unknown = operand.meaning == Meaning::symbol && !symbol(*declaration, value);
      const bool outside =
          operand.meaning == Meaning::address &&
          (value < 0 || value >= static_cast<std::int64_t>(module_.program_length));
      if (unknown || outside) {
        return nullptr;
      }
    }
    return declaration;
  }

  [[nodiscard]] static std::optional<std::string_view> symbol(const CommandDeclaration& declaration,
                                                              std::int64_t value) {
    const auto found = std::ranges::find(declaration.symbols, value, &Symbol::value);
    return found != declaration.symbols.end() ? std::optional(found->name) : std::nullopt;
  }

  [[nodiscard]] std::string operand(const Instruction& instruction,
                                    const CommandDeclaration& declaration,
                                    const Operand& operand) const {
    const std::int64_t value = field_of(instruction, operand.field);
    std::string number = std::to_string(value);
    if (operand.meaning == Meaning::symbol) {
      return std::string(*symbol(declaration, value));
    }
    if (operand.meaning == Meaning::address) {
      const auto address = static_cast<std::size_t>(value);
      return address < targets_.size() ? label(address) : number;
    }
    if (!options_.parameter_symbols) {
      return number;
    }
    const ParameterDeclaration* parameter =
        operand.meaning == Meaning::axis_parameter ? module_.axis_parameter(instruction.type)
        : operand.meaning == Meaning::global_parameter
            ? module_.global_parameter(instruction.motor, instruction.type)
            : nullptr;
    return parameter != nullptr ? std::string(parameter->symbol) : number;
  }

  std::span<const Instruction> program_;
  const ModuleDescription& module_;
  const DisassemblyOptions& options_;
  std::vector<Target> targets_;  ///< by address, one behind the end included
};

}  // namespace

std::string disassemble(std::span<const Instruction> program, const ModuleDescription& module,
                        const DisassemblyOptions& options) {
  return Disassembler(program, module, options).text();
}

}  // namespace stator::tmcl
