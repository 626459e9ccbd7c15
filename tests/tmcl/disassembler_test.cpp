// TMCL programs as text, and that any program assembles to itself again.
#include "stator/tmcl/assembler/disassembler.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "tmcl/test_module.hpp"

namespace stator::tmcl {
namespace {

std::string text_of(const std::vector<Instruction>& program,
                    const DisassemblyOptions& options = {}) {
  return disassemble(program, tests::test_module(), options);
}

std::vector<Instruction> assembled(const std::string& text) {
  const Assembly assembly = assemble(text, tests::test_module());
  EXPECT_TRUE(assembly.succeeded()) << text << assembly.diagnostics.front().message;
  return assembly.program.instructions;
}

TEST(Disassembler, WritesOneCommandPerLineAndLabelsWhereJumpsLeadTo) {
  EXPECT_EQ(text_of({{4, 0, 0, 10000},
                     {23, 0, 0, 4},
                     {21, 5, 0, 0},
                     {22, 0, 0, 0},
                     {27, 1, 0, -5},
                     {24, 0, 0, 0}}),
            "L0:      MVP ABS, 0, 10000\n"
            "         CSUB Sub4\n"
            "         JC GE, L0\n"
            "         JA L0\n"
            "Sub4:    WAIT POS, 0, -5\n"
            "         RSUB\n");
}

TEST(Disassembler, WritesParametersByTheirSymbolsOrNumbers) {
  const std::vector<Instruction> program{{5, 6, 0, 8}, {10, 7, 2, 0}, {10, 7, 1, 0}, {6, 77, 0, 0}};
  EXPECT_EQ(text_of(program),
            "         SAP MAX_CURRENT, 0, 8\n"
            "         GGP VARIABLE_7, 2\n"
            "         GGP 7, 1\n"
            "         GAP 77, 0\n");
  EXPECT_EQ(text_of(program, {.parameter_symbols = false}),
            "         SAP 6, 0, 8\n"
            "         GGP 7, 2\n"
            "         GGP 7, 1\n"
            "         GAP 77, 0\n");
}

TEST(Disassembler, WritesRawWhatNoMnemonicExpresses) {
  EXPECT_EQ(text_of({{0, 0, 0, 0},      // no command
                     {130, 0, 0, 0},    // none of a program
                     {4, 3, 0, 0},      // MVP of an unknown kind
                     {3, 0, 0, 7},      // MST with a value
                     {22, 0, 0, 2048},  // JA out of the memory
                     {22, 0, 0, -1}}),
            "         RAW 0, 0, 0, 0\n"
            "         RAW 130, 0, 0, 0\n"
            "         RAW 4, 3, 0, 0\n"
            "         RAW 3, 0, 0, 7\n"
            "         RAW 22, 0, 0, 2048\n"
            "         RAW 22, 0, 0, -1\n");
}

TEST(Disassembler, JumpsBehindTheProgramKeepTheirAddress) {
  EXPECT_EQ(text_of({{22, 0, 0, 20}}), "         JA 20\n");
  EXPECT_EQ(text_of({{22, 0, 0, 1}}),
            "         JA L1\n"
            "L1:\n");
}

TEST(Disassembler, AnEmptyProgramIsAnEmptyText) {
  EXPECT_EQ(text_of({}), "");
}

/// Values near those where something changes, and any other.
std::int32_t any_value(base::Random& random) {
  constexpr std::array<std::int32_t, 12> kEdges{0,    1,    -1,   2,     10,          255,
                                                2047, 2048, 4096, 65536, -2147483648, 2147483647};
  return random.below(3) == 0   ? static_cast<std::int32_t>(random.next())
         : random.below(2) == 0 ? kEdges[random.below(kEdges.size())]
                                : static_cast<std::int32_t>(random.below(100));
}

std::uint8_t any_byte(base::Random& random) {
  return static_cast<std::uint8_t>(random.below(3) == 0 ? random.next() : random.below(14));
}

std::vector<Instruction> any_program(base::Random& random) {
  std::vector<Instruction> program(random.below(60));
  const auto commands = classic_command_set().all();
  for (Instruction& each : program) {
    each = {.command = any_byte(random),
            .type = any_byte(random),
            .motor = any_byte(random),
            .value = any_value(random)};
    if (random.below(8) != 0) {
      each.command = static_cast<std::uint8_t>(commands[random.below(commands.size())].command);
    }
    if (random.below(2) == 0) {
      each.motor = 0;
    }
    if (random.below(3) == 0) {
      each.value = 0;
    }
  }
  return program;
}

TEST(Disassembler, AnyProgramAssemblesToItselfAgain) {
  base::Random random(142);
  std::size_t raw = 0;
  std::size_t named = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::vector<Instruction> program = any_program(random);
    const std::string text = text_of(program, {.parameter_symbols = random.below(2) == 0});
    ASSERT_EQ(assembled(text), program) << text;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at) {
      const std::size_t start = text.rfind('\n', at - 1) + 1;
      ++(text.find("RAW", start) < at ? raw : named);
    }
  }
  EXPECT_GT(raw, 10000U);
  EXPECT_GT(named, 10000U);
}

/// A line that the assembler takes, of any command, with labels L0 to L9.
std::string any_line(base::Random& random) {
  const auto commands = classic_command_set().all();
  const CommandDeclaration* command = &commands[random.below(commands.size())];
  while (!command->use.program) {
    command = &commands[random.below(commands.size())];
  }
  std::string line(command->mnemonic);
  for (std::size_t i = 0; i < command->operand_count(); ++i) {
    line += i == 0 ? " " : random.below(2) == 0 ? ", " : ",";
    const Operand& operand = command->operands[i];
    if (operand.meaning == Meaning::symbol) {
      line += command->symbols[random.below(command->symbols.size())].name;
    } else if (operand.meaning == Meaning::address) {
      line += random.below(4) == 0 ? "12" : "L" + std::to_string(random.below(10));
    } else if (operand.field == Field::value) {
      line += random.below(4) == 0 ? "-Far + 2 * $1F" : std::to_string(any_value(random));
    } else if (operand.meaning == Meaning::axis_parameter && random.below(2) == 0) {
      line += tests::kAxisParameters[random.below(tests::kAxisParameters.size())].symbol;
    } else {
      line += std::to_string(random.below(256));
    }
  }
  return line;
}

TEST(Disassembler, AnyValidTextKeepsItsInstructions) {
  base::Random random(2014);
  for (int i = 0; i < 1000; ++i) {
    std::string text = "Far = 12345\n";
    for (int label = 0; label < 10; ++label) {
      text += "L" + std::to_string(label) + ":";
      for (std::uint64_t line = random.below(4); line > 0; --line) {
        text += "  " + any_line(random) + (random.below(3) == 0 ? " // so\n" : "\n");
      }
      text += '\n';
    }
    const std::vector<Instruction> program = assembled(text);
    const std::string again = text_of(program);
    ASSERT_EQ(assembled(again), program) << text << again;
    ASSERT_EQ(text_of(assembled(again)), again);
    ASSERT_EQ(again.find("RAW"), std::string::npos) << again;
  }
}

}  // namespace
}  // namespace stator::tmcl
