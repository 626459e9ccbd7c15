// A program of a TMCM-142 waits for the EEPROM it writes, beside hosts that write too.

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tmcm_142_busy.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::Reply;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

constexpr base::SimDuration kWriteTime = devices::tmcm_142::Eeprom::kWriteTime;
constexpr int kTelegramPause = 75;

TEST_F(Tmcm142Busy, AProgramWaitsForTheInstructionThatWrites) {
  // Output 1 on, AGP 3 of the variables' bank is no write, the telegram pause is; output 2 on.
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>{
      {.command = number(Command::set_output), .type = 1, .motor = 2, .value = 1},
      {.command = number(Command::accumulator_to_global_parameter), .type = 3, .motor = 2},
      {.command = number(Command::set_global_parameter), .type = 75, .motor = 0, .value = 2},
      {.command = number(Command::set_output), .type = 2, .motor = 2, .value = 1},
      {.command = number(Command::stop)}});
  module.run(1_ms);
  write();
  module.device->tmcl().start_program(module.now);
  module.run(300_us);
  EXPECT_EQ(module.signal("output1"), 1.0);
  EXPECT_EQ(module.signal("program_counter"), 2.0) << "of the instruction that is executed";
  memory.finish(true);
  module.run(kWriteTime - 1_ns);
  EXPECT_EQ(module.signal("output2"), 0.0);
  EXPECT_EQ(module.signal("program_counter"), 2.0);
  module.run(1_ns);
  EXPECT_EQ(module.signal("output2"), 1.0) << "the next pass is at that moment";
  EXPECT_EQ(kept_global(kTelegramPause), 2);
  module.run(1_ms);
  EXPECT_EQ(module.signal("program_status"), 0.0);
}

TEST_F(Tmcm142Busy, AProgramIsPassedOverWhatCannotBeKept) {
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>{
      {.command = number(Command::set_global_parameter), .type = 75, .motor = 0, .value = 2},
      {.command = number(Command::set_output), .type = 2, .motor = 2, .value = 1},
      {.command = number(Command::jump_always), .value = 0}});
  module.run(1_ms);
  write();
  module.device->tmcl().start_program(module.now);
  memory.answer = ModuleMemory::Answer::failed;
  module.run(20_ms);
  EXPECT_EQ(module.signal("output2"), 1.0);
  EXPECT_EQ(module.ggp(kTelegramPause), 0);
  EXPECT_EQ(module.events.count("at address 0 refused with status 5"), 1) << "not in every pass";
  EXPECT_GT(memory.orders, 10);
}

TEST_F(Tmcm142Busy, AHostsWriteHoldsTheProgramAndTheMotionGoesOn) {
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>{
      {.command = number(Command::set_output), .type = 1, .motor = 2, .value = 1},
      {.command = number(Command::set_output), .type = 1, .motor = 2, .value = 0},
      {.command = number(Command::jump_always), .value = 0}});
  module.run(1_ms);
  write();
  module.device->tmcl().start_program(module.now);
  send(Command::rotate_right, 0, 0, 500'000);
  EXPECT_TRUE(reply());
  module.run(50_ms);
  const double counter = module.signal("program_counter");
  send(Command::store_axis_parameter, 4, 0);
  const double position = module.signal("axis0.shaft_position");
  module.run(kWriteTime - 1_us);
  EXPECT_EQ(module.signal("program_counter"), counter);
  EXPECT_GT(module.signal("axis0.shaft_position"), position);
  memory.finish(true);
  module.run(200_us);
  EXPECT_TRUE(reply());
  EXPECT_NE(module.signal("program_counter"), counter);
}

TEST_F(Tmcm142Busy, AHostHasItsTurnBesideAProgramThatWritesInEveryPass) {
  memory.answer = ModuleMemory::Answer::later;
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>{
      {.command = number(Command::set_global_parameter), .type = 75, .motor = 0, .value = 0},
      {.command = number(Command::set_global_parameter), .type = 75, .motor = 0, .value = 0},
      {.command = number(Command::jump_always), .value = 0}});
  module.run(1_ms);
  write();
  module.device->tmcl().start_program(module.now);
  module.run(150_us);
  send(Command::get_axis_parameter, 6, 0);
  EXPECT_FALSE(reply());
  EXPECT_NE(module.device->next_serial_reply(), base::SimTime::never());
  memory.finish(true);
  module.run(kWriteTime);
  EXPECT_TRUE(reply());
}

TEST_F(Tmcm142Busy, AProgramThatWritesInEveryPassWritesNoMoreOftenThanTheEepromCan) {
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>{
      {.command = number(Command::set_global_parameter), .type = 75, .motor = 0, .value = 0},
      {.command = number(Command::jump_always), .value = 0}});
  module.run(1_ms);
  write();
  const int before = memory.orders;
  module.device->tmcl().start_program(module.now);
  for (int i = 0; i < 10'000; ++i) {
    module.run(100_us);
    memory.finish(true);
  }
  EXPECT_GT(memory.orders - before, 150);
  EXPECT_LE(memory.orders - before, 200);
}

TEST_F(Tmcm142Busy, AStepIsAnsweredWhenItsInstructionIsKept) {
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>{
      {.command = number(Command::set_global_parameter), .type = 75, .motor = 0, .value = 2}});
  module.run(1_ms);
  write();
  EXPECT_EQ(written(Command::step_application, 0, 0), Status::success);
  EXPECT_EQ(module.signal("program_counter"), 1.0);
  EXPECT_EQ(kept_global(kTelegramPause), 2);
}

}  // namespace
}  // namespace stator::tests
