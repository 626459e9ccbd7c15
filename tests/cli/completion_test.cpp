// Completion of command lines, by the program itself and through the scripts of the shells.
#include <cstdlib>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using tests::Outcome;
using tests::run_in_shell;
using tests::stator;

/// What fits at the end of `line`, as the shells' scripts ask for it.
std::string fitting(const std::string& line, const std::string& more = "") {
  const Outcome outcome = stator("complete --line '" + line + "' " + more);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return outcome.output;
}

TEST(Completion, OfCommandsHasTheirSummaries) {
  EXPECT_EQ(fitting("stator dev"), "words\ndevices\tList the products that can be run\n");
  EXPECT_EQ(fitting("stator sdo "), "words\nread\tRead an object\nwrite\tWrite an object\n");
  EXPECT_THAT(fitting("stator "), Not(HasSubstr("\ncomplete\t"))) << "is for scripts only";
}

TEST(Completion, OfOptionsKnowsTheirNamesAndValues) {
  EXPECT_THAT(fitting("stator run --pr"), StartsWith("words\n--priority\t"));
  EXPECT_EQ(fitting("stator run --wait "), "words\nblock\nspin\nadaptive\n");
  EXPECT_EQ(fitting("stator run --wait=s"), "words\n--wait=spin\n");
  EXPECT_EQ(fitting("stator run --wait spin --clock r"), "words\nreal\n");
  EXPECT_THAT(fitting("stator move --r"), HasSubstr("--revolutions\t")) << "of an option group";
}

TEST(Completion, OfProductsAndFaultsComesFromTheirLists) {
  EXPECT_THAT(fitting("stator run --device tmcm-3"), StartsWith("words\ntmcm-3315\t"));
  EXPECT_THAT(fitting("stator describe tmcc"), StartsWith("words\ntmcc160\t"));
  EXPECT_THAT(fitting("stator faults motor-s"), HasSubstr("\nmotor-stall\t"));
  EXPECT_THAT(
      fitting("stator inject ethercat-drop "),
      AllOf(StartsWith("words nospace\n"), HasSubstr("\ncount=\t"), HasSubstr("\nwhen.cycles=\t")));
  EXPECT_EQ(fitting("stator inject nosuch-fault c"), "words\n");
}

TEST(Completion, OfFilesIsLeftToTheShell) {
  EXPECT_EQ(fitting("stator check r"), "files toml json\n");
  EXPECT_EQ(fitting("stator replay "), "files stator\n");
  EXPECT_EQ(fitting("stator run racks/gantry.toml --capture "), "files\n");
  EXPECT_EQ(fitting("stator run --state "), "directories\n");
}

TEST(Completion, OfLinksKnowsTheirForms) {
  EXPECT_THAT(fitting("stator run --port soc"),
              AllOf(StartsWith("words nospace\n"), HasSubstr("\nsocketcand:\tsocketcand:["),
                    HasSubstr("\nsocketcan:\tsocketcan:INTERFACE")));
  EXPECT_THAT(fitting("stator run --link t"), HasSubstr("\ntap:\ttap:NAME\n"));
}

TEST(Completion, AnswersOnlyWhatTheShellReplaces) {
  EXPECT_EQ(fitting("stator run --wait=s", "--breaks '=:'"), "words\nspin\n");
}

TEST(Completion, UnderstandsQuotesAndWhatStandsBehindTwoDashes) {
  EXPECT_EQ(fitting("stator run \"a file\" --capture "), "files\n");
  EXPECT_EQ(fitting("stator can-exec -- candump --l"), "words\n");
}

/// Runs `script` in bash with the completion loaded; `words` as bash divides the line.
std::string bash_completes(const std::string& line, const std::string& words) {
  const std::string path = tests::temporary("completion.bash");
  std::ofstream(path) << "source <(" STATOR_PROGRAM " completion bash) || exit 1\n"
                      << "COMP_LINE=\"" << line << "\" COMP_POINT=${#COMP_LINE}\n"
                      << "COMP_WORDBREAKS=$' \\t\\n\"\\'><=;|&(:'\n"
                      << "COMP_WORDS=(" << words << ") COMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                      << "_stator " STATOR_PROGRAM " \"\" \"\" 2>/dev/null\n"
                      << "printf '%s\\n' \"${COMPREPLY[@]}\"\n";
  const Outcome outcome = run_in_shell("cd " STATOR_SOURCE_DIR " && bash " + path);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return outcome.output;
}

TEST(Completion, AnswersInBash) {
  EXPECT_EQ(bash_completes("stator conf", "stator conf"), "conformance\n");
  EXPECT_EQ(bash_completes("stator run --wait=s", "stator run --wait = s"), "spin\n");
  EXPECT_EQ(bash_completes("stator run --wait=", "stator run --wait ="), "block\nspin\nadaptive\n");
  EXPECT_EQ(bash_completes("stator check racks/gantry.", "stator check racks/gantry."),
            "racks/gantry.toml\n");
}

class CompletionScript : public ::testing::TestWithParam<const char*> {};

TEST_P(CompletionScript, IsSyntaxOfItsShell) {
  const std::string shell = GetParam();
  if (run_in_shell("command -v " + shell).status != 0) {
    GTEST_SKIP() << shell << " is not installed; scripts/setup test";
  }
  const std::string path = tests::temporary("completion." + shell);
  ASSERT_EQ(stator("completion " + shell + " > " + path).status, 0);
  const Outcome outcome = run_in_shell(shell + " -n " + path + " 2>&1");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_EQ(outcome.output, "");
}

INSTANTIATE_TEST_SUITE_P(All, CompletionScript, ::testing::Values("bash", "zsh", "fish"));

TEST(Completion, AnswersInFish) {
  if (run_in_shell("command -v fish").status != 0) {
    GTEST_SKIP() << "fish is not installed; scripts/setup test";
  }
  const std::string path = tests::temporary("completion.fish");
  std::ofstream(path) << STATOR_PROGRAM " completion fish | source\n"
                      << "complete -C '" STATOR_PROGRAM " snapshot r'\n";
  const Outcome outcome = run_in_shell("HOME=" + ::testing::TempDir() + " fish " + path + " 2>&1");
  EXPECT_EQ(outcome.output, "restore\tBring the rack back to what was kept\n");
}

}  // namespace
}  // namespace stator
