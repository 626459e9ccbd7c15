// Where a TMCL command continues, from which the assembler sees a program that runs past its end.
#include "stator/tmcl/assembler/program_flow.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/tmcl/assembler/assembler.hpp"
#include "tmcl/test_module.hpp"

namespace stator::tmcl {
namespace {

bool runs_past_end(const std::string& text) {
  const Assembly assembly = assemble(text, tests::test_module());
  EXPECT_TRUE(assembly.succeeded());
  return can_run_past_end(assembly.program.instructions);
}

TEST(ProgramFlow, CommandsThatContinueLeadPastTheEnd) {
  EXPECT_TRUE(runs_past_end("MST 0"));
  EXPECT_TRUE(runs_past_end("A: JC ZE, A"));
  EXPECT_TRUE(runs_past_end("WAIT POS, 0, 0"));
  EXPECT_TRUE(runs_past_end("JA B\nA: RSUB\nB: CSUB A")) << "the subroutine returns";
  EXPECT_TRUE(runs_past_end("RAW 200, 0, 0, 0"));
  EXPECT_TRUE(runs_past_end("CSUB A\nSTOP\nA: MST 0")) << "inside the subroutine";
}

TEST(ProgramFlow, StopJumpAndReturnEndAProgram) {
  EXPECT_FALSE(runs_past_end(""));
  EXPECT_FALSE(runs_past_end("MST 0\nSTOP"));
  EXPECT_FALSE(runs_past_end("A: MST 0\nJA A"));
  EXPECT_FALSE(runs_past_end("A: CSUB B\nJA A\nB: RSUB"));
}

TEST(ProgramFlow, WhatIsNeverReachedDoesNotCount) {
  EXPECT_FALSE(runs_past_end("STOP\nMST 0"));
  EXPECT_FALSE(runs_past_end("A: JA A\nMST 0"));
  EXPECT_TRUE(runs_past_end("JC EQ, A\nSTOP\nA: MST 0"));
}

TEST(ProgramFlow, OnlyJumpsHaveATarget) {
  EXPECT_EQ(jump_target({22, 0, 0, 7}), 7U);
  EXPECT_EQ(jump_target({21, 0, 0, 0}), 0U);
  EXPECT_EQ(jump_target({23, 0, 0, 2047}), 2047U);
  EXPECT_FALSE(jump_target({22, 0, 0, -7}));
  EXPECT_FALSE(jump_target({20, 0, 0, 7}));
}

}  // namespace
}  // namespace stator::tmcl
