// Manual pages: made from what commands declare, and without mistakes in roff.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using tests::Outcome;
using tests::run_in_shell;
using tests::stator;

TEST(ManualPage, TellsWhatACommandDeclares) {
  const Outcome page = stator("man run");
  EXPECT_EQ(page.status, 0);
  EXPECT_THAT(page.output,
              AllOf(HasSubstr(".SH NAME\nstator\\-run \\- Run a rack of virtual devices on real "
                              "interfaces\n"),
                    HasSubstr("\\fB\\-\\-wait\\fR \\fIblock|spin|adaptive\\fR\n"),
                    HasSubstr("(1 to 500; 1 if left out)"),
                    HasSubstr(".SH EXAMPLES\n.EX\n  stator run racks/gantry.toml")));
}

TEST(ManualPage, OfTheProgramListsCommandsAndExitStatuses) {
  const Outcome page = stator("man");
  EXPECT_THAT(page.output, AllOf(HasSubstr("\\fBstator\\-simulate\\fR(1)\n"),
                                 HasSubstr(".SH EXIT STATUS\n.EX\n  0  done\n")));
}

TEST(ManualPage, OfNoCommandIsRefusedWithTheNearest) {
  const Outcome outcome = stator("man tmcl rum");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("did you mean \"run\"?"));
}

/// The pages of all commands in a directory of their own.
std::string all_pages() {
  const std::string directory = tests::temporary("man");
  std::filesystem::remove_all(directory);
  const Outcome outcome = stator("man --directory " + directory);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_TRUE(std::filesystem::exists(directory + "/stator.1"));
  EXPECT_TRUE(std::filesystem::exists(directory + "/stator-tmcl-run.1"));
  return directory;
}

TEST(ManualPage, OfEveryCommandHasNothingThatMandocWarnsOf) {
  if (run_in_shell("command -v mandoc").status != 0) {
    GTEST_SKIP() << "mandoc is not installed; scripts/setup test";
  }
  // A page has no date: it is of the program, whose version it names, and the same whenever made.
  const Outcome outcome = run_in_shell("cd " + all_pages() +
                                       " && mandoc -T lint -W warning *.1 2>&1 | grep -v "
                                       "'missing date'");
  EXPECT_EQ(outcome.output, "");
}

TEST(ManualPage, OfEveryCommandHasNothingThatGroffWarnsOf) {
  if (run_in_shell("command -v groff").status != 0) {
    GTEST_SKIP() << "groff is not installed; scripts/setup test";
  }
  const Outcome outcome = run_in_shell(
      "cd " + all_pages() +
      " && for page in *.1; do groff -man -K utf8 -T utf8 -ww \"$page\" 2>&1 >/dev/null; done");
  EXPECT_EQ(outcome.output, "");
}

}  // namespace
}  // namespace stator
