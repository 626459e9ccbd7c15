// The commands of the TMCL debugger: stepping, breakpoints, watchpoints, values, files of commands.
#include "stator/tmcl_tools/tmcl_debug_console.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/tmcl_tools/tmcl_debugger.hpp"
#include "tmcl_tools/tmcl_programs.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using tests::module_as_new;
using tests::program;

constexpr const char* kText =
    "Far = 2 * 256\n"             // 1
    "Loop:  MVP REL, 0, Far\n"    // 2, address 0
    "       CSUB Settle\n"        // 3, address 1
    "       GGP VARIABLE_0, 2\n"  // 4, address 2
    "       CALC ADD, 1\n"        // 5, address 3
    "       AGP VARIABLE_0, 2\n"  // 6, address 4
    "       COMP 3\n"             // 7, address 5
    "       JC LT, Loop\n"        // 8, address 6
    "       STOP\n"               // 9, address 7
    "Settle: WAIT POS, 0, 0\n"    // 10, address 8
    "       WAIT TICKS, 0, 5\n"   // 11, address 9
    "       RSUB\n";              // 12, address 10

class TmclDebugConsole : public testing::Test {
 protected:
  std::string say(const std::string& line) {
    const tmcl_tools::DebugResponse response = console_.execute(line);
    EXPECT_FALSE(response.failed) << line << ": " << response.text;
    return response.text;
  }
  std::string refusal(const std::string& line) {
    const tmcl_tools::DebugResponse response = console_.execute(line);
    EXPECT_TRUE(response.failed) << line;
    return response.text;
  }

  tmcl_tools::TmclDebugger debugger_{module_as_new, program(kText), {}};
  tests::FilesInMemory files_;
  tmcl_tools::TmclDebugConsole console_{debugger_, files_.access().read};
};

TEST_F(TmclDebugConsole, StandsBeforeTheFirstCommandAndSteps) {
  EXPECT_EQ(console_.current_line(), "2\tLoop:  MVP REL, 0, Far\n");
  EXPECT_EQ(say("step"), "3\t       CSUB Settle\n");
  EXPECT_EQ(say("s"), "10\tSettle: WAIT POS, 0, 0\n");
  EXPECT_EQ(say("backtrace"),
            "#0  Settle (program.tmc:10)\n"
            "#1  Loop+1 (program.tmc:3)\n");
  EXPECT_EQ(say("finish"), "4\t       GGP VARIABLE_0, 2\n");
}

TEST_F(TmclDebugConsole, NextPassesOverSubroutinesAndEmptyLinesRepeat) {
  say("next");
  EXPECT_EQ(say("next"), "4\t       GGP VARIABLE_0, 2\n");
  EXPECT_EQ(say(""), "5\t       CALC ADD, 1\n");
  EXPECT_EQ(say("n 2"), "7\t       COMP 3\n");
}

TEST_F(TmclDebugConsole, BreakpointsHoldByLineLabelAddressAndCondition) {
  EXPECT_EQ(say("break 5"), "Breakpoint 1 at Loop+3 (program.tmc:5)\n");
  EXPECT_THAT(say("run"), HasSubstr("Breakpoint 1, Loop+3 (program.tmc:5), "));
  EXPECT_EQ(say("print $accu"), "$accu = 0\n");
  say("delete 1");
  say("break *6 if VARIABLE_0 == 2");
  EXPECT_THAT(say("continue"), HasSubstr("Breakpoint 2, Loop+6 (program.tmc:8)"));
  EXPECT_EQ(say("p VARIABLE_0"), "VARIABLE_0 = 2\n");
  say("tbreak Settle");
  EXPECT_THAT(say("c"), HasSubstr("Breakpoint 3, Settle (program.tmc:10)"));
  EXPECT_THAT(say("info breakpoints"), Not(HasSubstr("Settle")));
  EXPECT_THAT(say("c"), HasSubstr("The program stopped at Loop+7"));
}

TEST_F(TmclDebugConsole, BreakpointsCanRestBeIgnoredAndBeCounted) {
  say("break Settle");
  say("ignore 1 1");
  say("run");
  EXPECT_THAT(say("info breakpoints"), HasSubstr("1    breakpoint  y       2  Settle: WAIT POS"));
  say("disable 1");
  EXPECT_THAT(say("c"), HasSubstr("The program stopped"));
}

TEST_F(TmclDebugConsole, AWatchpointHoldsAfterTheCommandThatChangedTheValue) {
  say("watch VARIABLE_0");
  EXPECT_THAT(say("run"), HasSubstr("Old value = 0\nNew value = 1\n"));
  EXPECT_THAT(say("c"), HasSubstr("Old value = 1\nNew value = 2\n"));
  EXPECT_EQ(console_.current_line(), "7\t       COMP 3\n");
}

TEST_F(TmclDebugConsole, AWatchpointSeesTheMotorMoveWhileAWaitHoldsTheProgram) {
  say("watch ACTUAL_POSITION >= 100");
  EXPECT_THAT(say("run"), HasSubstr("Old value = 0\nNew value = 1\n"));
  EXPECT_EQ(console_.current_line(), "10\tSettle: WAIT POS, 0, 0\n");
  EXPECT_EQ(say("p ACTUAL_POSITION < 110"), "ACTUAL_POSITION < 110 = 1\n");
}

TEST_F(TmclDebugConsole, AProgramBehavesAsItDoesWithoutTheDebugger) {
  tmcl_tools::TmclBench alone(module_as_new());
  alone.start(debugger_.source().program().instructions);
  while (alone.running()) {
    alone.advance_to_next(base::SimTime::never());
  }
  say("break Loop");
  say("watch ACTUAL_POSITION > 700");
  while (debugger_.bench().running()) {
    say("step");
  }
  EXPECT_EQ(debugger_.bench().now(), alone.now());
  EXPECT_EQ(debugger_.bench().executed(), alone.executed());
}

TEST_F(TmclDebugConsole, ValuesAreReadAndSetByName) {
  EXPECT_EQ(say("print Far + MAX_CURRENT * 2"), "Far + MAX_CURRENT * 2 = 528\n");
  EXPECT_EQ(say("print Settle"), "Settle = 8\n");
  say("set MAX_CURRENT = 3");
  EXPECT_EQ(say("p ap[6]"), "ap[6] = 3\n");
  say("set var coord[2] = -5");
  EXPECT_EQ(say("p coord[2]"), "coord[2] = -5\n");
  say("set $accu = 40");
  say("set $x = 2");
  EXPECT_EQ(say("p $accu + $x"), "$accu + $x = 42\n");
  EXPECT_EQ(say("p/x $accu"), "$accu = 0x28\n");
  say("set input input3 = 1");
  EXPECT_EQ(say("p in[3]"), "in[3] = 1\n");
  say("set out[1] = 1");
  EXPECT_EQ(say("p out[1] != 0"), "out[1] != 0 = 1\n");
}

TEST_F(TmclDebugConsole, CommandsOfAFileAreObeyedUpToTheFirstThatFails) {
  files_.texts["begin.gdb"] = "break 5\n# a remark\nrun\nnonsense\nstep\n";
  EXPECT_THAT(say("source begin.gdb"),
              AllOf(HasSubstr("Breakpoint 1, Loop+3"), EndsWith("\"help\" lists them\n")));
  EXPECT_EQ(refusal("source none.gdb"), "cannot read none.gdb: there is none\n");
}

TEST_F(TmclDebugConsole, CommandsInDirectModeMayBeCalled) {
  EXPECT_EQ(say("call GAP MAX_CURRENT, 0"), "MAX_CURRENT (axis parameter 6) = 8, of 15\n");
  EXPECT_EQ(say("call sap 6 0 99"), "refused: invalid value (status 4)\n");
}

TEST_F(TmclDebugConsole, TimePassesNoFurtherThanAskedFor) {
  say("continue 2ms");
  EXPECT_EQ(debugger_.bench().now().nanoseconds(), 2'000'000);
  say("continue 500us");
  EXPECT_EQ(say("p $time"), "$time = 2\n");
}

TEST_F(TmclDebugConsole, CtrlCHoldsAProgramThatRuns) {
  int looks = 0;
  debugger_.set_interruption([&looks] { return ++looks == 2; });
  EXPECT_THAT(say("run"), HasSubstr("Interrupted"));
  EXPECT_TRUE(debugger_.bench().running());
}

TEST_F(TmclDebugConsole, DisplaysAreToldWhereverTheProgramIsHeld) {
  say("display VARIABLE_0");
  EXPECT_EQ(say("step"), "3\t       CSUB Settle\n1: VARIABLE_0 = 0\n");
  say("undisplay 1");
  EXPECT_EQ(say("step"), "10\tSettle: WAIT POS, 0, 0\n");
}

TEST_F(TmclDebugConsole, RunBeginsAnewWithAModuleAsNew) {
  say("set MAX_CURRENT = 3");
  say("break 4");
  say("run");
  EXPECT_EQ(say("p MAX_CURRENT"), "MAX_CURRENT = 8\n");
  say("start");
  EXPECT_EQ(debugger_.bench().now(), base::SimTime());
}

TEST_F(TmclDebugConsole, UntilLeavesALoopAndGoesToPlaces) {
  say("until 8");
  EXPECT_EQ(console_.current_line(), "8\t       JC LT, Loop\n");
  EXPECT_EQ(say("until"), "9\t       STOP\n") << "the loop has run to its end";
}

TEST_F(TmclDebugConsole, JumpGoesOnElsewhere) {
  EXPECT_THAT(say("jump 9"), HasSubstr("The program stopped at Loop+7"));
  EXPECT_EQ(debugger_.bench().executed(), 1U);
}

TEST_F(TmclDebugConsole, ListsShowWhereBreakpointsAndTheProgramAre) {
  say("break Settle");
  EXPECT_EQ(say("list 3"),
            "  1\tFar = 2 * 256\n"
            " >2\tLoop:  MVP REL, 0, Far\n"
            "  3\t       CSUB Settle\n"
            "  4\t       GGP VARIABLE_0, 2\n"
            "  5\t       CALC ADD, 1\n"
            "  6\t       AGP VARIABLE_0, 2\n"
            "  7\t       COMP 3\n"
            "  8\t       JC LT, Loop\n"
            "  9\t       STOP\n"
            "* 10\tSettle: WAIT POS, 0, 0\n");
  EXPECT_EQ(say(""), "  11\t       WAIT TICKS, 0, 5\n  12\t       RSUB\n");
}

TEST_F(TmclDebugConsole, WhatCannotBeDoneIsSaid) {
  EXPECT_EQ(refusal("brake 3"),
            "there is no command \"brake\" (did you mean \"break\"?); \"help\" lists them\n");
  EXPECT_THAT(refusal("break Nowhere"), HasSubstr("\"Nowhere\" is no place"));
  EXPECT_THAT(refusal("print MAX_CURENT"), HasSubstr("did you mean \"MAX_CURRENT\"?"));
  EXPECT_THAT(refusal("set MAX_CURRENT = 99"), HasSubstr("is refused: invalid value"));
  EXPECT_THAT(refusal("set in[3] = 1"), HasSubstr("can not be set here"));
  EXPECT_THAT(refusal("set input door = 1"), HasSubstr("there is no input \"door\""));
  EXPECT_THAT(refusal("finish"), HasSubstr("in no subroutine"));
  EXPECT_THAT(refusal("delete 7"), HasSubstr("there is no breakpoint \"7\""));
  EXPECT_THAT(refusal("d 1 2"), HasSubstr("there is no breakpoint"));
  EXPECT_THAT(refusal("di"), HasSubstr("may be: disable, display"));
}

TEST_F(TmclDebugConsole, ARefusedCommandHoldsTheProgramIfAskedTo) {
  tmcl_tools::TmclDebugger debugger(module_as_new, program("SAP MAX_CURRENT, 0, 99\nSTOP\n"), {});
  tmcl_tools::TmclDebugConsole console(debugger, files_.access().read);
  console.execute("catch refused");
  EXPECT_THAT(console.execute("run").text,
              HasSubstr("Refused with status 4: SAP MAX_CURRENT, 0, 99, 0.000100 s"));
}

TEST_F(TmclDebugConsole, WordsAreCompleted) {
  EXPECT_THAT(console_.completions("", "back"), Contains("backtrace"));
  EXPECT_THAT(console_.completions("break ", "se"), Contains("Settle"));
  EXPECT_THAT(console_.completions("print ", "max_cu"), Contains("MAX_CURRENT"));
  EXPECT_THAT(console_.completions("info ", "reg"), Contains("registers"));
}

TEST_F(TmclDebugConsole, EveryTopicTellsSomething) {
  for (const tmcl_tools::DebugTopic& topic : tmcl_tools::debug_topics()) {
    EXPECT_FALSE(say("info " + std::string(topic.name)).empty()) << topic.name;
  }
}

}  // namespace
}  // namespace stator
