// Programs of the whole command set, written in every notation the assembler knows.

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl/assembler/program_image.hpp"

namespace stator::devices {
namespace {

using tmcl::CommandDeclaration;
using tmcl::Field;
using tmcl::Instruction;
using tmcl::Meaning;
using tmcl::Operand;
using tmcl::ParameterDeclaration;

constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

bool fits(std::int64_t value) {
  return value >= kLeast && value <= kMost;
}

template <typename Range>
const auto& any_of(base::Random& random, const Range& range) {
  return range[random.below(range.size())];
}

/// Values near those where something changes, and any other.
std::int32_t any_value(base::Random& random) {
  constexpr std::array<std::int32_t, 12> kEdges{0,    1,    -1,   2,     10,          255,
                                                2047, 2048, 4096, 65536, -2147483648, 2147483647};
  return random.below(3) == 0   ? static_cast<std::int32_t>(random.next())
         : random.below(2) == 0 ? any_of(random, kEdges)
                                : static_cast<std::int32_t>(random.below(100));
}

std::uint8_t any_byte(base::Random& random) {
  return static_cast<std::uint8_t>(random.next());
}

std::int64_t field_of(const Instruction& instruction, Field field) {
  return field == Field::type    ? instruction.type
         : field == Field::motor ? instruction.motor
                                 : instruction.value;
}

void set_field(Instruction& instruction, Field field, std::int32_t value) {
  if (field == Field::type) {
    instruction.type = static_cast<std::uint8_t>(value);
  } else if (field == Field::motor) {
    instruction.motor = static_cast<std::uint8_t>(value);
  } else {
    instruction.value = value;
  }
}

std::int32_t any_operand(base::Random& random, const CommandDeclaration& command,
                         const Operand& operand, std::size_t program_length) {
  if (operand.meaning == Meaning::symbol) {
    return any_of(random, command.symbols).value;
  }
  if (operand.meaning == Meaning::address) {
    return static_cast<std::int32_t>(random.below(random.below(4) == 0 ? 2048 : program_length));
  }
  if (operand.field == Field::value) {
    return any_value(random);
  }
  return random.below(3) == 0 ? any_byte(random) : static_cast<std::int32_t>(random.below(3));
}

Instruction any_instruction(base::Random& random, std::size_t program_length) {
  if (random.below(16) == 0) {
    return {.command = any_byte(random),
            .type = any_byte(random),
            .motor = any_byte(random),
            .value = any_value(random)};
  }
  const auto commands = tmcm_142_description().commands.all();
  const CommandDeclaration* command = &any_of(random, commands);
  while (!command->use.program) {
    command = &any_of(random, commands);
  }
  Instruction instruction{.command = static_cast<std::uint8_t>(command->command)};
  for (std::size_t i = 0; i < command->operand_count(); ++i) {
    const Operand& operand = command->operands[i];
    set_field(instruction, operand.field, any_operand(random, *command, operand, program_length));
    if (operand.meaning == Meaning::axis_parameter && random.below(4) != 0) {
      instruction.type = any_of(random, tmcm_142::axis_parameters()).number;
    }
  }
  if (command->operands[0].meaning == Meaning::global_parameter && random.below(4) != 0) {
    const ParameterDeclaration& parameter = any_of(random, tmcm_142::global_parameters());
    instruction.type = parameter.number;
    instruction.motor = parameter.bank;
  }
  return instruction;
}

std::vector<Instruction> any_program(base::Random& random) {
  std::vector<Instruction> program(1 + random.below(60));
  for (Instruction& each : program) {
    each = any_instruction(random, program.size());
  }
  return program;
}

/// Writes a program as a person might: names or numbers, constants, expressions, labels.
class Writer {
 public:
  Writer(base::Random& random, const std::vector<Instruction>& program)
      : random_(random), program_(program) {
    for (std::size_t address = 0; address <= program.size(); ++address) {
      if (random_.below(3) == 0) {
        labels_.push_back(address);
      }
    }
  }

  [[nodiscard]] std::string text() {
    std::string text;
    for (int i = 0; i < 8; ++i) {
      const std::int32_t value = any_value(random_);
      text += varied("Constant" + std::to_string(i)) + gap() + '=' + gap() + number(value) + end();
      constants_.push_back(value);
    }
    for (std::size_t address = 0; address < program_.size(); ++address) {
      text += label(address) + gap() + line(program_[address]) + end();
    }
    return text + label(program_.size()) + end();
  }

 private:
  /// The same word to the assembler.
  [[nodiscard]] std::string varied(std::string word) {
    const std::uint64_t way = random_.below(3);
    for (char& c : word) {
      const auto letter = static_cast<unsigned char>(c);
      const bool upper = way == 0 || (way == 1 && random_.below(2) == 0);
      c = static_cast<char>(upper ? std::toupper(letter) : std::tolower(letter));
    }
    return word;
  }

  [[nodiscard]] std::string gap() {
    constexpr std::array<std::string_view, 4> kGaps{" ", "", "\t", "  "};
    return std::string(any_of(random_, kGaps));
  }

  [[nodiscard]] std::string end() {
    constexpr std::array<std::string_view, 5> kEnds{"\n", "\r\n", "// so: JA = 5, \"x\"\n", "\n\n",
                                                    "\n // alone\n"};
    return gap() + std::string(any_of(random_, kEnds));
  }

  [[nodiscard]] std::string literal(std::int64_t value) {
    if (random_.below(3) != 0) {
      return std::to_string(value);
    }
    constexpr std::string_view kDigits = "0123456789ABCDEF";
    std::string digits;
    for (auto rest = static_cast<std::uint32_t>(value); rest != 0 || digits.empty(); rest /= 16) {
      digits.insert(digits.begin(), kDigits[rest % 16]);
    }
    return (random_.below(2) == 0 ? "$" : "0x") + varied(digits);
  }

  /// An expression with that value, every step of which stays within 32 bits.
  [[nodiscard]] std::string number(std::int64_t value) {
    switch (random_.below(6)) {
      case 0:
        return sum(value, literal(value / 2), value / 2);
      case 1:
        return '(' + gap() + literal(value) + gap() + ')';
      case 2:
        return value % 3 == 0 ? literal(value / 3) + gap() + '*' + gap() + '3' : literal(value);
      case 3:
        return fits(value * 7) ? '(' + literal(value * 7) + ") / 7" : literal(value);
      case 4:
        if (!constants_.empty()) {
          const std::size_t index = random_.below(constants_.size());
          return sum(value, varied("constant" + std::to_string(index)), constants_[index]);
        }
        [[fallthrough]];
      default:
        return literal(value);
    }
  }

  /// `value` as what `known` is, and the difference; or without it.
  [[nodiscard]] std::string sum(std::int64_t value, const std::string& known, std::int64_t is) {
    const std::int64_t rest = value - is;
    if (!fits(rest) || !fits(-rest)) {
      return literal(value);
    }
    if (rest == 0 && random_.below(2) == 0) {
      return known;
    }
    return rest < 0 ? known + gap() + '-' + gap() + literal(-rest)
                    : known + gap() + '+' + gap() + literal(rest);
  }

  [[nodiscard]] bool has_label(std::size_t address) const {
    return std::ranges::binary_search(labels_, address);
  }

  [[nodiscard]] std::string label(std::size_t address) {
    if (!has_label(address)) {
      return "";
    }
    constexpr std::array<std::string_view, 3> kAfter{"", "\n", " // here\n"};
    return varied("Label_" + std::to_string(address)) + gap() + ':' +
           std::string(any_of(random_, kAfter));
  }

  [[nodiscard]] std::string address(std::int64_t target) {
    if (labels_.empty() || random_.below(4) == 0) {
      return std::to_string(target);
    }
    const auto wanted = static_cast<std::size_t>(target);
    const std::size_t from = has_label(wanted) ? wanted : any_of(random_, labels_);
    return sum(target, varied("label_" + std::to_string(from)), static_cast<std::int64_t>(from));
  }

  [[nodiscard]] std::string operand(const Instruction& instruction,
                                    const CommandDeclaration& command, const Operand& operand) {
    const std::int64_t value = field_of(instruction, operand.field);
    if (operand.meaning == Meaning::symbol) {
      return varied(
          std::string(std::ranges::find(command.symbols, value, &tmcl::Symbol::value)->name));
    }
    if (operand.meaning == Meaning::address) {
      return address(value);
    }
    const tmcl::ModuleDescription& module = tmcm_142_description();
    const ParameterDeclaration* parameter =
        operand.meaning == Meaning::axis_parameter ? module.axis_parameter(instruction.type)
        : operand.meaning == Meaning::global_parameter
            ? module.global_parameter(instruction.motor, instruction.type)
            : nullptr;
    return parameter != nullptr && random_.below(2) == 0 ? varied(std::string(parameter->symbol))
                                                         : number(value);
  }

  /// Null if only RAW can express it.
  [[nodiscard]] static const CommandDeclaration* mnemonic_form(const Instruction& instruction) {
    const CommandDeclaration* command = tmcm_142_description().commands.find(instruction.command);
    if (command == nullptr || !command->use.program) {
      return nullptr;
    }
    Instruction expressed{.command = instruction.command};
    for (std::size_t i = 0; i < command->operand_count(); ++i) {
      const Operand& operand = command->operands[i];
      const std::int64_t value = field_of(instruction, operand.field);
      set_field(expressed, operand.field, static_cast<std::int32_t>(value));
      if ((operand.meaning == Meaning::symbol &&
           std::ranges::count(command->symbols, value, &tmcl::Symbol::value) == 0) ||
          (operand.meaning == Meaning::address && (value < 0 || value > 2047))) {
        return nullptr;
      }
    }
    return expressed == instruction ? command : nullptr;
  }

  [[nodiscard]] std::string line(const Instruction& instruction) {
    const CommandDeclaration* command = mnemonic_form(instruction);
    if (command == nullptr || random_.below(20) == 0) {
      return varied("RAW") + ' ' + number(instruction.command) + ',' + number(instruction.type) +
             gap() + ',' + number(instruction.motor) + ", " + number(instruction.value);
    }
    std::string line = varied(std::string(command->mnemonic));
    for (std::size_t i = 0; i < command->operand_count(); ++i) {
      line += (i == 0 ? " " : gap() + ',') + gap();
      line += operand(instruction, *command, command->operands[i]);
    }
    return line;
  }

  base::Random& random_;
  const std::vector<Instruction>& program_;
  std::vector<std::size_t> labels_;  ///< addresses, ascending
  std::vector<std::int32_t> constants_;
};

std::vector<Instruction> assembled(const std::string& text) {
  const tmcl::Assembly assembly = tmcl::assemble(text, tmcm_142_description());
  for (const tmcl::Diagnostic& each : assembly.diagnostics) {
    EXPECT_EQ(each.severity, tmcl::Severity::warning)
        << each.line << ':' << each.column << ": " << each.message;
  }
  return assembly.program.instructions;
}

TEST(Tmcm142ProgramTexts, EveryNotationMeansTheInstructionsItWasWrittenFor) {
  base::Random random(44);
  std::set<std::uint8_t> commands;
  for (int i = 0; i < 4000; ++i) {
    const std::vector<Instruction> program = any_program(random);
    const std::string text = Writer(random, program).text();
    ASSERT_EQ(assembled(text), program) << text;
    for (const Instruction& each : program) {
      commands.insert(each.command);
    }
  }
  for (const CommandDeclaration& each : tmcm_142_description().commands.all()) {
    EXPECT_TRUE(commands.contains(static_cast<std::uint8_t>(each.command))) << each.name.view();
  }
}

/// Executed even during a download (A87), so that no telegram brings it into the memory.
bool is_control(const Instruction& instruction) {
  return instruction.command >= 128 && instruction.command <= 137;
}

TEST(Tmcm142ProgramTexts, AssemblingDisassemblingAndAssemblingAgainIsTheIdentity) {
  base::Random random(45);
  for (int i = 0; i < 4000; ++i) {
    const std::vector<Instruction> program = assembled(Writer(random, any_program(random)).text());
    for (const bool symbols : {true, false}) {
      const std::string text =
          tmcl::disassemble(program, tmcm_142_description(), {.parameter_symbols = symbols});
      const std::vector<Instruction> again = assembled(text);
      ASSERT_EQ(again, program) << text;
      ASSERT_EQ(tmcl::disassemble(again, tmcm_142_description(), {.parameter_symbols = symbols}),
                text);
    }
    ASSERT_EQ(tmcl::program_in(tmcl::image_of(program)), program);
    if (std::ranges::none_of(program, is_control)) {
      ASSERT_EQ(tmcl::program_in(tmcl::download_of(program, any_byte(random))), program);
    }
  }
}

}  // namespace
}  // namespace stator::devices
