// The commands of the TMCL shell in direct mode, with downloads, refusals and completion.
#include "stator/tmcl_tools/tmcl_shell.hpp"

#include <array>
#include <span>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/tmcl_tools/tmcl_bench_connection.hpp"
#include "tmcl_tools/tmcl_programs.hpp"

namespace stator {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class TmclShell : public testing::Test {
 protected:
  std::string say(const std::string& line) {
    const tmcl_tools::ShellResponse response = shell_.execute(line);
    EXPECT_FALSE(response.refused) << line << ": " << response.text;
    return response.text;
  }
  std::string refusal(const std::string& line) {
    const tmcl_tools::ShellResponse response = shell_.execute(line);
    EXPECT_TRUE(response.refused) << line;
    return response.text;
  }

  tests::FilesInMemory files_;
  tmcl_tools::TmclBench bench_{tests::module_as_new()};
  tmcl_tools::TmclBenchConnection connection_{bench_, "tmcm-142",
                                              tmcl_tools::BenchClock::simulated};
  tmcl_tools::TmclShell shell_{connection_, devices::tmcm_142_description(), files_.access()};
};

TEST_F(TmclShell, CommandsAreWrittenWithCommasOrSpacesAndInAnyCase) {
  EXPECT_EQ(say("sap 6 0 5"), "done\n");
  EXPECT_EQ(say("GAP MAX_CURRENT, 0"), "MAX_CURRENT (axis parameter 6) = 5, of 15\n");
  EXPECT_EQ(say("sap max_current 0 7"), "done\n");
  EXPECT_EQ(say("  gap\tmax_current 0 // behind"), "MAX_CURRENT (axis parameter 6) = 7, of 15\n");
}

TEST_F(TmclShell, AnswersAreInWords) {
  EXPECT_EQ(say("ggp 66 0"), "SERIAL_ADDRESS (global parameter, bank 0, 66) = 1\n");
  EXPECT_EQ(say("gio 3 0"), "input 3 = 0\n");
  say("input input3=1");
  EXPECT_EQ(say("gio 3 0"), "input 3 = 1\n");
  EXPECT_EQ(say("gio 255 0"), "all inputs = 8 (00001000)\n");
  say("sco 2 0 -77");
  EXPECT_EQ(say("gco 2 0"), "coordinate 2 = -77, microsteps\n");
  EXPECT_EQ(say("rfs status 0"), "no reference search is active\n");
  EXPECT_EQ(say("version"), "142V4.45 (0000042dh)\n");
}

TEST_F(TmclShell, RefusalsNameTheirStatus) {
  EXPECT_EQ(refusal("sap 6 0 99"), "refused: invalid value (status 4)\n");
  EXPECT_EQ(refusal("gap 200 0"), "refused: wrong type (status 3)\n");
  EXPECT_EQ(refusal("ja 0"), "refused: command not available (status 6)\n");
  EXPECT_EQ(refusal("gap 200, 0, 0"), "found 3 operands; expected 2: GAP parameter, motor\n");
  EXPECT_THAT(refusal("gpa 1 0"), HasSubstr("did you mean \"GAP\"?"));
}

TEST_F(TmclShell, MovesAreWaitedFor) {
  say("mvp abs 0 500");
  EXPECT_EQ(say("wait pos"), "the target was reached\n");
  EXPECT_EQ(say("gap 1 0"), "ACTUAL_POSITION (axis parameter 1) = 500, microsteps\n");
  say("event");
  say("mvp rel 0 -500");
  EXPECT_EQ(say("wait event"), "the target was reached\n");
}

TEST_F(TmclShell, ProgramsAreDownloadedReadBackRunAndStopped) {
  files_.texts["loop.tmc"] = "Loop: WAIT TICKS, 0, 1\nJA Loop\n";
  EXPECT_EQ(say("download loop.tmc"), "2 commands are in the program memory\n");
  EXPECT_EQ(say("upload 2"), "L0:      WAIT TICKS, 0, 1\n         JA L0\n");
  EXPECT_EQ(say("status"), "the program is stopped\n");
  say("run 0");
  say("wait 100ms");
  EXPECT_EQ(say("status"), "the program is running\n");
  say("halt");
  EXPECT_EQ(say("status"), "the program is stopped\n");
  say("reset");
  EXPECT_EQ(say("status"), "the program is reset\n");
}

TEST_F(TmclShell, ProgramsThatCannotBeDownloadedAreRefusedAndTheirErrorsTold) {
  EXPECT_EQ(refusal("download none.tmc"), "cannot read none.tmc: there is none\n");
  files_.texts["wrong.tmc"] = "MVP ABS, 0\n";
  EXPECT_EQ(refusal("download wrong.tmc"), "wrong.tmc has 1 error; it does not run\n");
  EXPECT_THAT(files_.told, StartsWith("wrong.tmc:1:"));
  files_.texts["empty.tmc"] = "// nothing\n";
  EXPECT_EQ(refusal("download empty.tmc"), "empty.tmc contains no command; write at least STOP\n");
  files_.texts["bytes.hex"] = "1c 00 00 00 00 00 00\n";
  EXPECT_EQ(say("download bytes.hex"), "1 commands are in the program memory\n");
}

TEST_F(TmclShell, WordsAreCompletedByTheirPlaceInTheCommand) {
  EXPECT_THAT(shell_.completions("", "rf"), Contains("RFS"));
  EXPECT_THAT(shell_.completions("", "ver"), Contains("version"));
  EXPECT_THAT(shell_.completions("sap ", "max_c"), Contains("MAX_CURRENT"));
  EXPECT_THAT(shell_.completions("mvp ", ""), Contains("ABS"));
  EXPECT_TRUE(shell_.completions("sap 6, ", "max").empty()) << "a motor has no name";
}

TEST_F(TmclShell, HelpTellsWhatACommandTakes) {
  EXPECT_THAT(say("help mvp"), HasSubstr("MVP ABS|REL|COORD, motor, value"));
  EXPECT_THAT(say("help"), HasSubstr("download FILE"));
  EXPECT_THAT(refusal("help xyz"), HasSubstr("there is no command \"xyz\""));
}

TEST(TmclReply, IsReadFromTheBytesOfATelegram) {
  const tmcl::Instruction gap{.command = 6, .type = 1, .motor = 0, .value = 0};
  const std::array reply{std::byte{1}, std::byte{100},  std::byte{6},    std::byte{0},
                         std::byte{0}, std::byte{0x27}, std::byte{0x10}, std::byte{0xA5}};
  EXPECT_EQ(tmcl_tools::reply_in(reply, gap).value, 10000);
  EXPECT_EQ(tmcl_tools::reply_in(std::span(reply).first(7), gap).value, 10000)
      << "a short CAN frame";
  const tmcl::Instruction read{.command = 134, .type = 0, .motor = 0, .value = 0};
  const auto cell = tmcl_tools::reply_in(reply, read).cell;
  ASSERT_TRUE(cell.has_value());
  EXPECT_EQ(*cell, (tmcl::Instruction{1, 100, 6, 10000}));
}

}  // namespace
}  // namespace stator
