// Command lines that are wrong: what is said of them and the exit status.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using tests::Outcome;
using tests::stator;

void expect_usage_error(const std::string& arguments, const std::string& sentence) {
  const Outcome outcome = stator(arguments);
  EXPECT_EQ(outcome.status, 2) << arguments;
  EXPECT_EQ(outcome.output, "stator: " + sentence + "\n") << arguments;
}

TEST(Usage, AnUnknownCommandIsToldWithTheNearest) {
  expect_usage_error("stauts",
                     "stator has no command \"stauts\" (did you mean \"status\"?); "
                     "\"stator --help\" lists them");
  expect_usage_error("tmcl rum x.tmc",
                     "stator tmcl has no command \"rum\" (did you mean \"run\"?); "
                     "\"stator tmcl --help\" lists them");
  expect_usage_error("sdo raed 6041h",
                     "stator sdo has no command \"raed\" (did you mean \"read\"?); "
                     "\"stator sdo --help\" lists them");
}

TEST(Usage, AnUnknownCommandThatIsLikeNoOtherIsToldWithoutAGuess) {
  expect_usage_error("xyzzyplugh",
                     "stator has no command \"xyzzyplugh\"; \"stator --help\" lists them");
}

TEST(Usage, AMissingCommandIsAskedFor) {
  expect_usage_error("", "say which command; \"stator --help\" lists them");
  expect_usage_error("snapshot", "say which command; \"stator snapshot --help\" lists them");
}

TEST(Usage, AnUnknownOptionIsToldWithTheNearestWhateverElseIsMissing) {
  expect_usage_error("run --devise tmcm-3315",
                     "stator run has no option \"--devise\" (did you mean \"--device\"?); "
                     "\"stator run --help\" lists them");
  expect_usage_error("describe --fromat=csv",
                     "stator describe has no option \"--fromat\" (did you mean \"--format\"?); "
                     "\"stator describe --help\" lists them");
  expect_usage_error("move --device tmcm-3315 --revolution 1",
                     "stator move has no option \"--revolution\" (did you mean "
                     "\"--revolutions\"?); \"stator move --help\" lists them");
  expect_usage_error("--verion",
                     "stator has no option \"--verion\" (did you mean \"--version\"?); "
                     "\"stator --help\" lists them");
}

TEST(Usage, AnArgumentTooManyIsNamed) {
  expect_usage_error("devices all of them",
                     "stator devices takes no further argument, and \"all\" is one; "
                     "\"stator devices --help\" tells its use");
}

TEST(Usage, AWordThatIsNoneOfAListIsToldWithTheNearest) {
  const Outcome outcome = stator("check racks/gantry.toml --format jsn");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.output,
              HasSubstr("--format: jsn not in {text,json} (did you mean \"json\"?)"));
  EXPECT_THAT(outcome.output, HasSubstr("\"stator check --help\" tells its use"));
}

TEST(Usage, TheHelpOfTheProgramTellsExitStatusesAndThatOfCommandsNotItsExamples) {
  const Outcome program = stator("--help");
  EXPECT_EQ(program.status, 0);
  EXPECT_THAT(program.output, HasSubstr("Exit status:\n  0  done\n"));
  const Outcome group = stator("mfc --help");
  EXPECT_EQ(group.status, 0);
  EXPECT_THAT(group.output, Not(HasSubstr("stator demo")));
}

}  // namespace
}  // namespace stator
