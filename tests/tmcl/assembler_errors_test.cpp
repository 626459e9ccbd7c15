#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/tmcl/assembler/assembler.hpp"
#include "tmcl/test_module.hpp"

namespace stator::tmcl {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// As a compiler prints them: "2:5: error: what is wrong".
std::vector<std::string> messages(const std::string& text,
                                  const ModuleDescription& module = tests::test_module()) {
  const Assembly assembly = assemble(text, module);
  std::vector<std::string> lines;
  for (const Diagnostic& each : assembly.diagnostics) {
    const bool error = each.severity == Severity::error;
    EXPECT_TRUE(!error || (!assembly.succeeded() && assembly.program.instructions.empty()));
    lines.push_back(std::to_string(each.line) + ':' + std::to_string(each.column) +
                    (error ? ": error: " : ": warning: ") + each.message);
  }
  return lines;
}

/// Of one line, in front of a STOP.
std::string message(const std::string& line) {
  const auto lines = messages(line + "\nSTOP");
  EXPECT_LE(lines.size(), 1U);
  return lines.empty() ? "" : lines.front();
}

TEST(AssemblerErrors, MisspelledWordsAreNamedWithTheLikelyOnes) {
  EXPECT_EQ(message("MPV ABS, 0, 1"),
            "1:1: error: \"MPV\" is no command for programs of the test-2; did you mean \"MVP\"?");
  EXPECT_EQ(message("MVP ABZ, 0, 1"),
            "1:5: error: found \"ABZ\"; expected ABS, REL or COORD; did you mean \"ABS\"?");
  EXPECT_EQ(message("SAP MAX_CURENT, 0, 1"),
            "1:5: error: \"MAX_CURENT\" is no constant; did you mean \"MAX_CURRENT\"?");
  EXPECT_EQ(message("Loop: JA Lop"),
            "1:10: error: \"Lop\" is neither label nor constant; did you mean \"Loop\"?");
  EXPECT_EQ(message("COMP Somewhere"), "1:6: error: \"Somewhere\" is no constant");
}

TEST(AssemblerErrors, CommandsOfOtherModulesAreRefused) {
  EXPECT_THAT(messages("VECTOR 1, 2"), ElementsAre(::testing::HasSubstr("is no command")));
  EXPECT_THAT(messages("SAC 0, 1, 2"), ElementsAre(::testing::HasSubstr("is no command")));
}

TEST(AssemblerErrors, AWrongNumberOfOperandsTellsTheSyntax) {
  EXPECT_EQ(
      message("WAIT POS, 0"),
      "1:12: error: found 2 operands; expected 3: WAIT TICKS|POS|REFSW|LIMSW|RFS, motor, ticks");
  EXPECT_EQ(message("MST"), "1:4: error: found 0 operands; expected 1: MST motor");
  EXPECT_EQ(message("RSUB 3"), "1:6: error: found 1 operand; expected none: RSUB");
  EXPECT_EQ(message("RAW 1, 2, 3"),
            "1:12: error: found 3 operands; expected 4: RAW command, type, motor, value");
  EXPECT_EQ(message("SGP 7, 2, 1, 4"),
            "1:14: error: found 4 operands; expected 3: SGP parameter, bank, value");
}

TEST(AssemblerErrors, NumbersBeyondTheirFieldAreRefused) {
  EXPECT_EQ(message("COMP 2147483648"),
            "1:6: error: found 2147483648; expected a number of 32 bits, -2147483648..2147483647");
  EXPECT_EQ(message("COMP 4294967296"), "1:6: error: \"4294967296\" is no number of 32 bits");
  EXPECT_EQ(message("COMP 12k"), "1:6: error: \"12k\" is no number of 32 bits");
  EXPECT_EQ(message("COMP 0x"), "1:6: error: \"0x\" is no number of 32 bits");
  EXPECT_EQ(message("COMP 65536 * 65536"), "1:12: error: 4294967296 is beyond 32 bits");
  EXPECT_EQ(message("GAP 256, 0"), "1:5: error: found 256; expected a parameter, 0..255");
  EXPECT_EQ(message("MST -1"), "1:5: error: found -1; expected a motor, 0..255");
  EXPECT_EQ(message("RAW 300, 0, 0, 0"), "1:5: error: found 300; expected a byte, 0..255");
  EXPECT_EQ(message("JA 2048"),
            "1:4: error: found 2048; expected a place in the program memory, 0..2047");
  EXPECT_EQ(message("JA 0 - 1"),
            "1:4: error: found -1; expected a place in the program memory, 0..2047");
}

TEST(AssemblerErrors, ExpressionsAreReadToTheirEnd) {
  EXPECT_EQ(message("COMP 1 2"),
            "1:8: error: found \"2\"; expected an operator, a comma or the end of the line");
  EXPECT_EQ(message("COMP (1 + 2"), "1:12: error: found the end of the line; expected \")\"");
  EXPECT_EQ(message("COMP 1 +"),
            "1:9: error: found the end of the line; expected a number or a name");
  EXPECT_EQ(message("SGP 7, , 1"), "1:8: error: found \",\"; expected a number or a name");
  EXPECT_EQ(message("COMP 1 / (1 - 1)"), "1:8: error: division by zero");
  EXPECT_EQ(message("MVP ABS + 1, 0, 0"), "1:9: error: found \"+\"; expected a comma");
  EXPECT_EQ(message("COMP " + std::string(1000, '(')),
            "1:70: error: more than 64 parentheses within another");
}

TEST(AssemblerErrors, LinesThatAreNothingAreRefused) {
  EXPECT_EQ(message("= 5"), "1:1: error: found \"=\"; expected a label, a command or a constant");
  EXPECT_EQ(message("#include \"x.tmc\""),
            "1:1: error: found \"#\"; directives are not known, a program is one text");
  EXPECT_EQ(message("Loop MST 0"),
            "1:1: error: \"Loop\" is no command for programs of the test-2; a label needs a colon "
            "behind it");
  EXPECT_EQ(message("\xC3\xA4: MST 0"),
            "1:1: error: found \"\xC3\xA4\"; expected a label, a command or a constant");
}

TEST(AssemblerErrors, ColumnsCountCharactersNotBytes) {
  EXPECT_EQ(message("Loop: \xC3\xA4 MST 0"),
            "1:7: error: found \"\xC3\xA4\"; expected a label, a command or a constant");
  EXPECT_EQ(message("COMP \xC3\xA4\xC3\xA4 + Q"),
            "1:6: error: found \"\xC3\xA4\"; expected a number or a name");
  EXPECT_EQ(message("COMP 1 \xC3\xA4 ) 2"),
            "1:8: error: found \"\xC3\xA4\"; expected an operator, a comma or the end of the line");
}

TEST(AssemblerErrors, NamesAreGivenOnce) {
  EXPECT_THAT(messages("Loop: MST 0\nA = 1\nLOOP: JA Loop\na = 2\nA: STOP"),
              ElementsAre("3:1: error: \"LOOP\" is there already, in line 1",
                          "4:1: error: \"a\" is there already, in line 2",
                          "5:1: error: \"A\" is there already, in line 2"));
  EXPECT_EQ(message("MAX_CURRENT = 5"),
            "1:1: error: \"MAX_CURRENT\" is the symbol of parameter 6; choose another name");
}

TEST(AssemblerErrors, AWrongConstantIsToldOnceAndNotWhereItIsUsed) {
  EXPECT_THAT(messages("A = 2147483648\nB = C\nCOMP A + B\nCOMP A\nSTOP"),
              ElementsAre("1:5: error: found 2147483648; expected a number of 32 bits, up to "
                          "2147483647",
                          "2:5: error: \"C\" is no constant"));
}

TEST(AssemblerErrors, LabelsAreNotNumbers) {
  EXPECT_EQ(message("Loop: COMP Loop"),
            "1:12: error: \"Loop\" is a label; expected a number or a constant");
}

TEST(AssemblerErrors, ParametersAreOfTheKindAndBankTheirCommandTakes) {
  EXPECT_EQ(message("GGP MAX_CURRENT, 0"),
            "1:5: error: \"MAX_CURRENT\" is an axis parameter; GGP expects a global parameter");
  EXPECT_EQ(message("SAP BAUD_RATE, 0, 1"),
            "1:5: error: \"BAUD_RATE\" is a global parameter; SAP expects an axis parameter");
  EXPECT_EQ(message("GGP VARIABLE_7, 0"),
            "1:17: error: found bank 0; expected 2, the bank of \"VARIABLE_7\"");
}

TEST(AssemblerErrors, AllErrorsOfATextComeInOneRun) {
  EXPECT_THAT(messages("SAP 999, 0, Q\nFOOBAR\nSTOP 1"),
              ElementsAre("1:5: error: found 999; expected a parameter, 0..255",
                          "1:13: error: \"Q\" is no constant",
                          "2:1: error: \"FOOBAR\" is no command for programs of the test-2",
                          "3:6: error: found 1 operand; expected none: STOP"));
}

TEST(AssemblerErrors, AProgramFitsIntoTheMemory) {
  ModuleDescription small = tests::test_module();
  small.program_length = 3;
  EXPECT_THAT(messages("MST 0\nMST 0\nSTOP", small), IsEmpty());
  EXPECT_THAT(messages("MST 0\nMST 0\nMST 0\nSTOP\nNONSENSE", small),
              ElementsAre("4:1: error: found command 4; the program memory of the test-2 holds 3"));
}

TEST(AssemblerWarnings, WhatTheModuleWillRefuseIsToldBeforehand) {
  EXPECT_EQ(message("MST 2"), "1:5: warning: found motor 2; the test-2 has motor 0..1");
  EXPECT_EQ(message("GAP 7, 0"), "1:5: warning: the test-2 has no axis parameter 7");
  EXPECT_EQ(message("GGP 7, 0"), "1:5: warning: the test-2 has no global parameter 7 in bank 0");
  EXPECT_EQ(message("AAP 8, 0"),
            "1:5: warning: axis parameter 8 (Position reached) can only be read");
  EXPECT_EQ(message("SGP STATUS, 0, 1"),
            "1:5: warning: global parameter 128 in bank 0 (status) can only be read");
  EXPECT_EQ(message("SAP 6, 0, 16"),
            "1:11: warning: axis parameter 6 (Max. current) takes 0..15; found 16");
  EXPECT_EQ(message("SAP 5, 0, 0"),
            "1:11: warning: axis parameter 5 (Max. acceleration) takes 1..16777215; found 0");
  EXPECT_EQ(message("SGP BAUD_RATE, 0, 12"),
            "1:19: warning: global parameter 65 in bank 0 (baud rate) takes 0..11; found 12");
  EXPECT_EQ(message("CCO 5, 0"), "1:5: warning: found coordinate 5; the test-2 has 0..4");
  EXPECT_EQ(message("MVP COORD, 0, -1"), "1:15: warning: found coordinate -1; the test-2 has 0..4");
  EXPECT_EQ(message("WAIT TICKS, 0, -1"), "1:16: warning: found -1 ticks; a time is not negative");
}

TEST(AssemblerWarnings, ParametersThatAreNotKeptCannotBeStoredNorRestored) {
  EXPECT_EQ(message("STAP 0, 0"),
            "1:6: warning: axis parameter 0 (Target position) is not kept in the EEPROM");
  EXPECT_EQ(message("RSAP 5, 1"),
            "1:6: warning: axis parameter 5 (Max. acceleration) is not kept in the EEPROM");
  EXPECT_EQ(message("STGP STATUS, 0"),
            "1:6: warning: global parameter 128 in bank 0 (status) is not kept in the EEPROM");
  EXPECT_EQ(message("RSGP VARIABLE_7, 2"),
            "1:6: warning: global parameter 7 in bank 2 (variable 7) is not kept in the EEPROM");
}

TEST(AssemblerWarnings, TheLockOfTheEepromTakesItsTwoKeysOnly) {
  for (const char* value : {"0", "1", "1233", "4320"}) {
    EXPECT_EQ(message("SGP LOCK, 0, " + std::string(value)),
              "1:14: warning: global parameter 73 in bank 0 (lock) takes 1234 to lock and 4321 to "
              "unlock; found " +
                  std::string(value));
  }
}

TEST(AssemblerWarnings, PortsThatTheModuleLacksAreTold) {
  EXPECT_EQ(message("SIO 3, 2, 1"),
            "1:5: warning: found output 3; the test-2 has 0..2, 7, and 255 for all");
  EXPECT_EQ(message("GIO 3, 2"), "1:5: warning: found output 3; the test-2 has 0..2, 7");
  EXPECT_EQ(message("GIO 255, 2"), "1:5: warning: found output 255; the test-2 has 0..2, 7");
  EXPECT_EQ(message("GIO 4, 0"),
            "1:5: warning: found digital input 4; the test-2 has 0..3, and 255 for all");
  EXPECT_EQ(message("GIO 1, 1"), "1:5: warning: found analog input 1; the test-2 has 0");
  EXPECT_EQ(message("GIO 255, 1"), "1:5: warning: found analog input 255; the test-2 has 0");
  EXPECT_EQ(message("GIO 32, 1"), "1:5: warning: found analog input 32; the test-2 has 0");
  ModuleDescription without = tests::test_module();
  without.analog_inputs = 0;
  EXPECT_THAT(messages("GIO 0, 1\nSTOP", without),
              ElementsAre("1:5: warning: found analog input 0; the test-2 has none"));
  without.outputs = 0x8000'0001;
  EXPECT_THAT(messages("SIO 30, 2, 1\nSTOP", without),
              ElementsAre("1:5: warning: found output 30; the test-2 has 0, 31, and 255 for all"));
}

TEST(AssemblerWarnings, BanksWithoutPortsAndValuesThatAreNoneOfAnOutputAreTold) {
  EXPECT_EQ(message("SIO 0, 0, 1"), "1:8: warning: found bank 0; outputs are in bank 2");
  EXPECT_EQ(message("GIO 0, 3"),
            "1:8: warning: found bank 3; digital inputs are in bank 0, analog ones in bank 1, "
            "outputs in bank 2");
  EXPECT_EQ(message("SIO 0, 2, 2"), "1:11: warning: an output takes 0 or 1; found 2");
  EXPECT_EQ(message("SIO 0, 2, -1"), "1:11: warning: an output takes 0 or 1; found -1");
  for (const char* value : {"256", "-2"}) {
    EXPECT_EQ(message("SIO 255, 2, " + std::string(value)),
              "1:13: warning: all outputs take 0..255, and -1 for the accumulator; found " +
                  std::string(value));
  }
}

TEST(AssemblerWarnings, WhatIsAllowedIsNotWarnedOf) {
  for (const char* line : {"SAP 5, 0, 500000000",
                           "GAP 8, 0",
                           "GGP STATUS, 0",
                           "STAP 6, 0",
                           "WAIT TICKS, 9, 1",
                           "SCO 1, 255, 0",
                           "GCO 1, 255",
                           "AAP 6, 1",
                           "MVP ABS, 0, 99",
                           "RAW 6, 77, 9, 0",
                           "SGP LOCK, 0, 1234",
                           "SGP LOCK, 0, 4321",
                           "AGP LOCK, 0",
                           "SGP VARIABLE_7, 2, 5",
                           "SIO 7, 2, 1",
                           "SIO 255, 2, -1",
                           "SIO 255, 2, 255",
                           "GIO 255, 0",
                           "GIO 3, 0",
                           "GIO 0, 1",
                           "GIO 7, 2",
                           "RAW 14, 40, 9, 9"}) {
    EXPECT_EQ(message(line), "") << line;
  }
}

TEST(AssemblerWarnings, AProgramThatCanRunPastItsEndIsTold) {
  EXPECT_THAT(messages("MST 0\n  MST 1 // end\n"),
              ElementsAre("2:3: warning: the program can run on behind its last command; expected "
                          "STOP or JA at its end"));
  EXPECT_THAT(messages("JA End\nMST 0\nEnd:"),
              ElementsAre("1:1: warning: the jump leads to address 2, behind the last command of "
                          "the program"));
  EXPECT_THAT(messages("MST 0\nSTOP"), IsEmpty());
}

}  // namespace
}  // namespace stator::tmcl
