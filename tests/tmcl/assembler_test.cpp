#include "stator/tmcl/assembler/assembler.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tmcl/test_module.hpp"

namespace stator::tmcl {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Assembles what has no error and needs no warning.
std::vector<Instruction> program(const std::string& text) {
  const Assembly assembly = assemble(text, tests::test_module());
  for (const Diagnostic& each : assembly.diagnostics) {
    ADD_FAILURE() << each.line << ':' << each.column << ": " << each.message;
  }
  return assembly.program.instructions;
}

/// The instruction of one line, in front of a STOP.
Instruction instruction(const std::string& line) {
  const auto instructions = program(line + "\nSTOP\n");
  return instructions.size() == 2 ? instructions.front() : Instruction{.command = 255};
}

TEST(Assembler, OperandsGoIntoTheFieldsOfTheirCommand) {
  EXPECT_EQ(instruction("ROL 0, 500000"), (Instruction{2, 0, 0, 500000}));
  EXPECT_EQ(instruction("MST 1"), (Instruction{3, 0, 1, 0}));
  EXPECT_EQ(instruction("MVP COORD, 1, 3"), (Instruction{4, 2, 1, 3}));
  EXPECT_EQ(instruction("SAP 6, 1, 15"), (Instruction{5, 6, 1, 15}));
  EXPECT_EQ(instruction("GGP 7, 2"), (Instruction{10, 7, 2, 0}));
  EXPECT_EQ(instruction("SIO 255, 2, -1"), (Instruction{14, 255, 2, -1}));
  EXPECT_EQ(instruction("CALC MUL, -5000"), (Instruction{19, 2, 0, -5000}));
  EXPECT_EQ(instruction("CALCX SWAP"), (Instruction{33, 10, 0, 0}));
  EXPECT_EQ(instruction("WAIT RFS, 1, 300"), (Instruction{27, 4, 1, 300}));
  EXPECT_EQ(instruction("CLE ESD"), (Instruction{36, 5, 0, 0}));
  EXPECT_EQ(instruction("UF3 1, 2, 3"), (Instruction{67, 1, 2, 3}));
}

TEST(Assembler, ConditionsOfJumpsStandBeforeTheLabel) {
  EXPECT_THAT(program("JC ESD, End\nJC ge, End\nEnd: STOP"),
              ElementsAre(Instruction{21, 12, 0, 2}, Instruction{21, 5, 0, 2}, Instruction{28}));
}

TEST(Assembler, LabelsAreAddressesOfInstructionsCountedFromZero) {
  const auto instructions = program(
      "// nothing here counts\n"
      "Start: First:\n"
      "\n"
      "  CSUB Turn // forward\n"
      "  JA Start\n"
      "Turn: RSUB\n");
  EXPECT_THAT(instructions,
              ElementsAre(Instruction{23, 0, 0, 2}, Instruction{22, 0, 0, 0}, Instruction{24}));
}

TEST(Assembler, JumpsMayNameAddressesAndDistances) {
  EXPECT_THAT(program("A: MST 0\nJA A + 1\nJA 1"),
              ElementsAre(Instruction{3}, Instruction{22, 0, 0, 1}, Instruction{22, 0, 0, 1}));
}

TEST(Assembler, LetterCaseDoesNotCount) {
  EXPECT_THAT(program("Loop: mvp abs, 0, Far\nfar = 5\nja LOOP"),
              ElementsAre(Instruction{4, 0, 0, 5}, Instruction{22}));
  EXPECT_EQ(instruction("sap max_current, 0, 3"), (Instruction{5, 6, 0, 3}));
}

TEST(Assembler, NumbersAreDecimalOrHexadecimal) {
  EXPECT_EQ(instruction("COMP $1f").value, 31);
  EXPECT_EQ(instruction("COMP 0x1F").value, 31);
  EXPECT_EQ(instruction("COMP -2147483648").value, -2147483648);
  EXPECT_EQ(instruction("COMP 2147483647").value, 2147483647);
  EXPECT_EQ(instruction("CALC AND, $FFFF0000").value, -65536) << "a pattern of 32 bits";
  EXPECT_EQ(instruction("CALC AND, 0XFFFFFFFF").value, -1);
}

TEST(Assembler, ExpressionsObeyTheOrderOfTheirOperators) {
  EXPECT_EQ(instruction("COMP 2 + 3 * 4").value, 14);
  EXPECT_EQ(instruction("COMP (2 + 3) * -4").value, -20);
  EXPECT_EQ(instruction("COMP 10 - 4 - 3").value, 3);
  EXPECT_EQ(instruction("COMP -7 / 2").value, -3);
  EXPECT_EQ(instruction("COMP 1 - -1").value, 2);
}

TEST(Assembler, ConstantsMayStandAnywhereAndUseEarlierOnes) {
  const Assembly assembly = assemble(
      "Turn = 200 * 256\n"
      "Far = 3 * turn + 1\n"
      "MVP ABS, 0, Far\n"
      "MVP ABS, Motor, -Far\n"
      "STOP\n"
      "Motor = 1\n",
      tests::test_module());
  EXPECT_THAT(assembly.diagnostics, IsEmpty());
  EXPECT_THAT(
      assembly.program.instructions,
      ElementsAre(Instruction{4, 0, 0, 153601}, Instruction{4, 0, 1, -153601}, Instruction{28}));
  ASSERT_EQ(assembly.program.constants.size(), 3U);
  EXPECT_EQ(assembly.program.constants[1].name, "Far");
  EXPECT_EQ(assembly.program.constants[1].value, 153601);
  EXPECT_EQ(assembly.program.constants[1].line, 2U);
}

TEST(Assembler, ParametersHaveSymbols) {
  EXPECT_EQ(instruction("SAP MAX_ACCELERATION, 0, 100"), (Instruction{5, 5, 0, 100}));
  EXPECT_EQ(instruction("AGP VARIABLE_7, 2"), (Instruction{35, 7, 2, 0}));
  EXPECT_EQ(instruction("GGP BAUD_RATE, 0"), (Instruction{10, 65, 0, 0}));
}

TEST(Assembler, AConstantMayRepeatTheNumberOfAParameter) {
  EXPECT_THAT(program("MAX_CURRENT = 6\nSAP MAX_CURRENT, 0, 8\nSTOP"),
              ElementsAre(Instruction{5, 6, 0, 8}, Instruction{28}));
}

TEST(Assembler, RawExpressesAnyInstruction) {
  EXPECT_EQ(instruction("RAW 0x80, 255, 1, -2"), (Instruction{128, 255, 1, -2}));
}

TEST(Assembler, LinesOfTheTextAreKeptForEveryAddress) {
  const Assembly assembly = assemble("\nROR 0, 1\n\n// x\nEnd: STOP\n", tests::test_module());
  EXPECT_THAT(assembly.program.lines, ElementsAre(2U, 5U));
  ASSERT_EQ(assembly.program.labels.size(), 1U);
  EXPECT_EQ(assembly.program.labels[0].name, "End");
  EXPECT_EQ(assembly.program.labels[0].address, 1U);
  EXPECT_EQ(assembly.program.labels[0].line, 5U);
}

TEST(Assembler, LinesMayEndAsOnAnySystem) {
  EXPECT_THAT(program("\xEF\xBB\xBFMST 0\r\nSTOP//"), ElementsAre(Instruction{3}, Instruction{28}));
  EXPECT_THAT(program(""), IsEmpty());
  EXPECT_THAT(program("// only a comment"), IsEmpty());
}

TEST(Assembler, LabelsAndParametersMayHaveTheSameName) {
  EXPECT_THAT(program("MAX_CURRENT: GAP MAX_CURRENT, 0\nJA MAX_CURRENT"),
              ElementsAre(Instruction{6, 6}, Instruction{22}));
}

}  // namespace
}  // namespace stator::tmcl
