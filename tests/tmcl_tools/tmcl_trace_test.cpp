// Traces and profiles of TMCL programs, and inputs that change at given times.
#include "stator/tmcl_tools/tmcl_trace.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "stator/tmcl_tools/tmcl_profile.hpp"
#include "tmcl_tools/tmcl_programs.hpp"

namespace stator {
namespace {

using base::SimDuration;
using base::SimTime;
using tests::module_as_new;
using tests::program;

constexpr SimTime kMillisecond(SimDuration(1'000'000));

/// What the trace of the first millisecond of `text` is.
std::string trace_of(const char* text, const tmcl_tools::TraceOptions& options,
                     SimTime until = kMillisecond) {
  const tmcl_tools::TmclSource source = program(text);
  char* written = nullptr;
  std::size_t size = 0;
  std::FILE* file = ::open_memstream(&written, &size);
  {
    tmcl_tools::TmclBench bench(module_as_new());
    tmcl_tools::TmclTrace trace(file, source, {}, options);
    bench.observe(trace);
    bench.start(source.program().instructions);
    bench.advance_to(until);
    EXPECT_TRUE(trace.good());
  }
  std::fclose(file);
  std::string content(written, size);
  std::free(written);
  return content;
}

TEST(TmclTrace, HasALineForEachInstructionWithRegistersAndStatus) {
  EXPECT_EQ(trace_of("Limit = 5\n"
                     "CALC LOAD, 7\n"
                     "CALCX SWAP\n"
                     "COMP Limit\n"
                     "SAP MAX_CURRENT, 0, 99\n"
                     "JC LT, End\n"
                     "CALC LOAD, 1\n"
                     "End: STOP\n",
                     {.csv = true}),
            "time [s],address,line,command,accumulator,x,flags,status\n"
            "0.000100,0,2,\"CALC LOAD, 7\",7,0,,100\n"
            "0.000200,1,3,CALCX SWAP,0,7,ZE,100\n"
            "0.000300,2,4,COMP 5,0,7,LT,100\n"
            "0.000400,3,5,\"SAP MAX_CURRENT, 0, 99\",0,7,LT,4\n"
            "0.000500,4,6,\"JC LT, End\",0,7,LT,100\n"
            "0.000600,6,8,STOP,0,7,LT,100\n");
}

TEST(TmclTrace, LeavesOutWhatPollingRepeatsButNotWhatFollowsAWait) {
  EXPECT_EQ(trace_of("Loop: GIO 3, 0\nJA Loop\n", {.csv = true, .changes_only = true}),
            "time [s],address,line,command,accumulator,x,flags,status\n"
            "0.000100,0,1,\"GIO 3, 0\",0,0,ZE,100\n"
            "0.000200,1,2,JA Loop,0,0,ZE,100\n");
  EXPECT_EQ(trace_of("Loop: WAIT TICKS, 0, 1\nJA Loop\n", {.csv = true, .changes_only = true},
                     SimTime(SimDuration(30'000'000))),
            "time [s],address,line,command,accumulator,x,flags,status\n"
            "0.010100,0,1,\"WAIT TICKS, 0, 1\",0,0,,100\n"
            "0.010200,1,2,JA Loop,0,0,,100\n"
            "0.020300,0,1,\"WAIT TICKS, 0, 1\",0,0,,100\n"
            "0.020400,1,2,JA Loop,0,0,,100\n");
}

TEST(TmclProfile, GivesAWaitItsTimeAndASubroutineThatOfItsCalls) {
  const tmcl_tools::TmclSource source = program(
      "CSUB Pause\n"
      "CSUB Pause\n"
      "STOP\n"
      "Pause: WAIT TICKS, 0, 3\n"
      "SAP MAX_CURRENT, 0, 99\n"
      "RSUB\n");
  tmcl_tools::TmclBench bench(module_as_new());
  tmcl_tools::TmclProfile profile(source.module(), bench.now());
  bench.observe(profile);
  bench.start(source.program().instructions);
  bench.advance_to(SimTime(SimDuration(1'000'000'000)));
  EXPECT_EQ(profile.at(0).executions, 1U);
  EXPECT_EQ(profile.at(3).executions, 2U);
  EXPECT_EQ(profile.at(3).time, SimDuration(2 * 30'100'000));
  EXPECT_EQ(profile.at(4).refused, 2U);
  EXPECT_EQ(profile.subroutine(3).executions, 2U);
  EXPECT_EQ(profile.subroutine(3).time, SimDuration(2 * 30'300'000));
  EXPECT_EQ(profile.at(1).time, SimDuration(100'000));
}

TEST(TmclBench, InputsChangeAtTheirTimesAndInTheirOrder) {
  const tmcl_tools::TmclSource source = program(
      "Loop: GIO 3, 0\n"
      "COMP 1\n"
      "JC NE, Loop\n"
      "STOP\n");
  tmcl_tools::TmclBench bench(module_as_new());
  bench.schedule({SimTime(SimDuration(70'000'000)), "input3", 1.0});
  bench.schedule({SimTime(SimDuration(50'000'000)), "input3", 1.0});
  bench.schedule({SimTime(SimDuration(50'000'000)), "input3", 0.0});
  bench.start(source.program().instructions);
  bench.advance_to(SimTime(SimDuration(69'900'000)));
  EXPECT_TRUE(bench.running()) << "the later of two changes at one time counts";
  bench.advance_to(SimTime(SimDuration(80'000'000)));
  EXPECT_FALSE(bench.running());
}

}  // namespace
}  // namespace stator
