// stator tmcl run, debug and shell with programs, inputs, recordings, scripts and refusals.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using tests::content;
using tests::Outcome;
using tests::stator;
using tests::temporary;

constexpr const char* kText =
    "Loop: GIO 3, 0\n"
    "COMP 1\n"
    "JC NE, Loop\n"
    "MVP ABS, 0, 100\n"
    "WAIT POS, 0, 0\n"
    "STOP\n";

/// A program in a file, for the commands that run programs.
class TmclRunCommand : public testing::Test {
 protected:
  TmclRunCommand() : path_(temporary("run.tmc")) { std::ofstream(path_) << kText; }
  ~TmclRunCommand() override { std::filesystem::remove(path_); }

  std::string path_;
};

TEST_F(TmclRunCommand, RunsUntilTheProgramStopsWithInputsSetInTime) {
  const Outcome outcome = stator("tmcl run " + path_ + " --at 5ms input3=1");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, HasSubstr("the program stopped at Loop+5 after "));
  EXPECT_THAT(stator("tmcl run " + path_ + " --input input3=1 --trace -").output,
              HasSubstr("WAIT POS, 0, 0"));
}

TEST_F(TmclRunCommand, EndsAfterTheTimeThatIsGiven) {
  EXPECT_THAT(stator("tmcl run " + path_ + " --for 20ms").output,
              HasSubstr("ended after 0.020000 s and 200 instructions; the program is at Loop+2"));
}

TEST_F(TmclRunCommand, BinaryProgramsRunLikeTheirText) {
  const std::string binary = temporary("run.bin");
  ASSERT_EQ(stator("tmcl assemble " + path_ + " --format binary -o " + binary).status, 0);
  EXPECT_THAT(stator("tmcl run " + binary + " --input input3=1 --profile").output,
              HasSubstr("MVP ABS, 0, 100"));
  std::filesystem::remove(binary);
}

TEST_F(TmclRunCommand, RecordsSignalsAndDrawsThem) {
  const std::string csv = temporary("run.csv");
  const std::string svg = temporary("run.svg");
  const Outcome outcome = stator("tmcl run " + path_ + " --input input3=1 --record " + csv +
                                 " --plot " + svg + " --signals axis0.torque");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(content(csv), StartsWith("time [s],axis0.torque [Nm]\n0.000000000,"));
  EXPECT_THAT(content(svg), HasSubstr("</svg>"));
  std::filesystem::remove(csv);
  std::filesystem::remove(svg);
}

TEST_F(TmclRunCommand, RefusalsOfTheProgramAreToldWithTheirReason) {
  std::ofstream(path_) << "SAP MAX_CURRENT, 0, 15\nGGP 200, 0\nSTOP\n";
  EXPECT_THAT(stator("tmcl run " + path_).output,
              HasSubstr("refusal: program: command GGP at address 1 refused with status 3"));
}

TEST_F(TmclRunCommand, WhatCannotBeDoneIsSaid) {
  EXPECT_THAT(stator("tmcl run " + path_ + " --input door=1").output,
              HasSubstr("there is no input \"door\""));
  EXPECT_THAT(stator("tmcl run " + path_ + " --at soon input3=1").output,
              HasSubstr("--at \"soon\" is no duration"));
  EXPECT_THAT(stator("tmcl run " + path_ + " --input input3").output,
              HasSubstr("write NAME=VALUE"));
  EXPECT_THAT(stator("tmcl run " + path_ + " --trace /nonexistent/x").output,
              HasSubstr("cannot write /nonexistent/x"));
  std::ofstream(path_) << "FOO\n";
  EXPECT_THAT(stator("tmcl run " + path_).output, HasSubstr(" has 1 error; it does not run"));
  std::ofstream(path_) << "// nothing\n";
  EXPECT_THAT(stator("tmcl run " + path_).output, HasSubstr("contains no command"));
}

TEST_F(TmclRunCommand, TheDebuggerTakesCommandsFromOptionsFilesAndPipes) {
  const std::string commands = temporary("commands.gdb");
  std::ofstream(commands) << "# to begin with\nbreak 5\nset input input3 = 1\ncontinue\n";
  const Outcome outcome =
      stator("tmcl debug " + path_ + " -x " + commands + " --ex 'print TARGET_POSITION' --batch");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("Breakpoint 1, Loop+4 "));
  EXPECT_THAT(outcome.output, HasSubstr("TARGET_POSITION = 100\n"));
  std::filesystem::remove(commands);
  EXPECT_EQ(stator("tmcl debug " + path_ + " --ex 'print FOO' --batch").status, 1);
  EXPECT_EQ(stator("tmcl debug " + path_).status, 0) << "an empty standard input ends it";
  EXPECT_THAT(stator("tmcl debug " + path_ + " --tui").output, HasSubstr("needs a terminal"));
}

TEST_F(TmclRunCommand, TheShellTakesScripts) {
  std::ofstream(path_) << "sap MAX_CURRENT 0 3\ngap MAX_CURRENT 0\nsap MAX_CURRENT 0 99\nversion\n";
  const std::string strict = std::string("tmcl shell --strict <") + path_ + " 2>&1 #";
  const Outcome outcome = stator(strict);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("MAX_CURRENT (axis parameter 6) = 3, of 15\n"));
  EXPECT_THAT(outcome.output, HasSubstr("1 command was refused"));
  EXPECT_THAT(outcome.output, Not(HasSubstr("142V4.45")));
  const Outcome lenient = stator(std::string("tmcl shell <") + path_ + " 2>&1 #");
  EXPECT_EQ(lenient.status, 0);
  EXPECT_THAT(lenient.output, HasSubstr("142V4.45 (0000042dh)"));
  EXPECT_THAT(stator("tmcl shell --port pty:/nonexistent").output,
              HasSubstr("cannot open /nonexistent"));
}

}  // namespace
}  // namespace stator
