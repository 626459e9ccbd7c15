// What an observer sees of each instruction of a TMCL program, and that it can stop it.
#include "stator/tmcl/interpreter/program_observer.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tmcl/firmware_fixture.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using enum Command;
using tests::instruction;
using ProgramObserverTest = tests::FirmwareFixture;

class Recorder : public ProgramObserver {
 public:
  [[nodiscard]] bool may_execute(base::SimTime /*now*/, std::uint16_t address,
                                 const Instruction& /*instruction*/) override {
    return address != breakpoint;
  }
  void executed(const ProgramStep& step, const Registers& registers) override {
    steps.push_back(step);
    accumulators.push_back(registers.accumulator);
  }
  std::vector<ProgramStep> steps;
  std::vector<std::int32_t> accumulators;
  int breakpoint = -1;
};

TEST_F(ProgramObserverTest, SeesEveryInstructionWithItsTime) {
  Recorder recorder;
  firmware_.interpreter().observe(&recorder);
  start({instruction(calculate, 9, 0, 5), instruction(wait, 0, 0, 1),
         instruction(set_axis_parameter, 6, 0, 99), instruction(Command::stop)});
  advance(1_s);
  ASSERT_EQ(recorder.steps.size(), 4U);
  for (std::uint16_t i = 0; i < 4; ++i) {
    EXPECT_EQ(recorder.steps[i].address, i);
    EXPECT_EQ(recorder.steps[i].instruction, firmware_.memory()[i]);
  }
  EXPECT_EQ(recorder.steps[0].time, base::SimTime(100_us));
  EXPECT_EQ(recorder.steps[1].time, base::SimTime(200_us + 10_ms)) << "when it let go";
  EXPECT_EQ(recorder.steps[2].time, base::SimTime(300_us + 10_ms));
  EXPECT_EQ(recorder.steps[2].status, Status::invalid_value);
  EXPECT_EQ(recorder.accumulators[0], 5);
  firmware_.interpreter().observe(nullptr);
}

TEST_F(ProgramObserverTest, StopsTheProgramAndLetsItGoOn) {
  Recorder recorder;
  recorder.breakpoint = 1;
  firmware_.interpreter().observe(&recorder);
  start({instruction(calculate, 0, 0, 1), instruction(calculate, 0, 0, 100),
         instruction(jump_always)});
  advance(1_s);
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(counter(), 1);
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(status(run_application), Status::success);
  advance(1_s);
  EXPECT_EQ(registers().accumulator, 102) << "one round more";
  EXPECT_EQ(counter(), 1);
  firmware_.interpreter().observe(nullptr);
}

}  // namespace
}  // namespace stator::tmcl
