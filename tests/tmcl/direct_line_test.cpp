#include "stator/tmcl/assembler/direct_line.hpp"

#include <string>

#include <gtest/gtest.h>

#include "tmcl/test_module.hpp"

namespace stator::tmcl {
namespace {

/// The command in a line as somebody types it.
Instruction command(const std::string& line) {
  const auto parsed = parse_direct_line(line, tests::test_module());
  EXPECT_TRUE(parsed) << line << ": " << parsed.error();
  return parsed ? *parsed : Instruction{};
}

std::string refusal(const std::string& line) {
  const auto parsed = parse_direct_line(line, tests::test_module());
  EXPECT_FALSE(parsed) << line;
  return parsed ? "" : parsed.error();
}

TEST(DirectLine, TakesOperandsWithCommasOrWithBlanks) {
  constexpr Instruction kExpected{.command = 5, .type = 6, .motor = 1, .value = 8};
  for (const char* const line :
       {"SAP 6, 1, 8", "SAP 6,1,8", "SAP 6 1 8", "sap\t6\t1\t8", "  sap   6  1   8  ",
        "SAP MAX_CURRENT 1 8", "sap max_current, 1, 8"}) {
    EXPECT_EQ(command(line), kExpected) << line;
  }
}

TEST(DirectLine, TakesCommandsWithOneOperandAndWithNone) {
  EXPECT_EQ(command("MST 1"), (Instruction{.command = 3, .motor = 1}));
  EXPECT_EQ(command("STOP"), (Instruction{.command = 28}));
  EXPECT_EQ(command(" stop "), (Instruction{.command = 28}));
}

TEST(DirectLine, WithACommaIsReadAsItStands) {
  EXPECT_EQ(command("SAP 3 + 3, 1, 8"),
            (Instruction{.command = 5, .type = 6, .motor = 1, .value = 8}));
}

TEST(DirectLine, TellsWhatIsWrong) {
  EXPECT_EQ(refusal("SAP MAX_CURENT 0 1"),
            "\"MAX_CURENT\" is no constant; did you mean \"MAX_CURRENT\"?");
  EXPECT_EQ(refusal("MST"), "found 0 operands; expected 1: MST motor");
}

TEST(DirectLine, WarningsDoNotKeepACommandBack) {
  EXPECT_EQ(command("SAP 6 1 99"), (Instruction{.command = 5, .type = 6, .motor = 1, .value = 99}))
      << "the module decides";
}

TEST(DirectLine, HoldsOneCommand) {
  constexpr const char* kNone = "found no command; expected e.g. GAP MAX_CURRENT, 0";
  for (const char* const line : {"", "   ", "// nothing"}) {
    EXPECT_EQ(refusal(line), kNone) << '"' << line << '"';
  }
  EXPECT_EQ(refusal("STOP\nSTOP"), kNone);
}

}  // namespace
}  // namespace stator::tmcl
