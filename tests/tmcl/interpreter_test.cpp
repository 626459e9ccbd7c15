// TMCL programs as they run: flow, conditions, waits, flags, subroutines, read protection.
#include "stator/tmcl/interpreter/interpreter.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tmcl/firmware_fixture.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using enum Command;
using tests::instruction;

class InterpreterTest : public tests::FirmwareFixture {
 protected:
  static Instruction load_constant(std::int32_t value) {
    return instruction(calculate, 9, 0, value);
  }
  static Instruction jump(int condition, std::int32_t address) {
    return instruction(jump_conditionally, condition, 0, address);
  }
  static Instruction set_variable(int number) {
    return instruction(accumulator_to_global_parameter, number, 2);
  }
  static Instruction end() { return instruction(Command::stop); }
};

TEST_F(InterpreterTest, OneInstructionIsExecutedInEveryPass) {
  start(
      {load_constant(1), instruction(calculate, 0, 0, 10), instruction(calculate, 2, 0, 3), end()});
  EXPECT_EQ(registers().accumulator, 0);
  advance(99'999_ns);
  EXPECT_EQ(registers().accumulator, 0) << "the first pass is 100 us after the start";
  advance(1_ns);
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(counter(), 1);
  pass(2);
  EXPECT_EQ(registers().accumulator, 33);
  EXPECT_EQ(application(), ApplicationStatus::run);
  EXPECT_EQ(firmware_.next_deadline(), now_ + 100_us);
  pass();
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(counter(), 3) << "the place of STOP";
  EXPECT_EQ(firmware_.next_deadline(), base::SimTime::never());
}

TEST_F(InterpreterTest, TheResultDoesNotDependOnHowOftenTimeIsTold) {
  const std::vector<Instruction> program{instruction(calculate, 0, 0, 1),
                                         instruction(wait, 0, 0, 1),
                                         instruction(jump_always, 0, 0, 0)};
  start(program);
  advance(10_s);
  const Registers at_once = registers();
  const int at_once_counter = counter();
  tests::FakeModule module;
  Firmware other(tests::FakeModule::description(), module);
  other.load_program(program);
  static_cast<void>(other.execute(instruction(run_application, 1), Origin::serial, {}));
  for (base::SimTime now; now <= base::SimTime(10_s); now += 137_us) {
    other.advance(now);
  }
  other.advance(base::SimTime(10_s));
  EXPECT_EQ(other.state().registers, at_once);
  EXPECT_EQ(other.state().program_counter, at_once_counter);
  EXPECT_GT(at_once.accumulator, 900);
}

TEST_F(InterpreterTest, TheRateIsASetting) {
  Firmware fast(tests::FakeModule::description(), module_, {.instruction_time = 1_us});
  fast.load_program(std::vector{instruction(calculate, 0, 0, 1), instruction(jump_always)});
  static_cast<void>(fast.execute(instruction(run_application), Origin::serial, {}));
  fast.advance(base::SimTime(2_ms));
  EXPECT_EQ(fast.state().registers.accumulator, 1000);
}

TEST_F(InterpreterTest, InstructionsCanBeExecutedAtOnce) {
  start({instruction(calculate, 0, 0, 1), instruction(jump_always)});
  EXPECT_EQ(firmware_.interpreter().run_at_once(1'000'001, now_), 1'000'001U);
  EXPECT_EQ(registers().accumulator, 500'001);
  pass();
  EXPECT_EQ(registers().accumulator, 500'001) << "the jump";
  load({instruction(calculate, 0, 0, 1), instruction(wait, 0, 0, 5), end()});
  EXPECT_EQ(status(run_application, 1), Status::success);
  EXPECT_EQ(firmware_.interpreter().run_at_once(100, now_), 2U) << "a WAIT holds the program";
  EXPECT_EQ(firmware_.interpreter().run_at_once(100, now_), 0U);
  now_ += 50_ms;
  EXPECT_EQ(firmware_.interpreter().run_at_once(100, now_), 1U);
  EXPECT_EQ(application(), ApplicationStatus::stop);
}

TEST_F(InterpreterTest, ReadingCommandsLoadTheAccumulator) {
  module_.position = 711;
  module_.inputs = 0x12;
  module_.search = 3;
  EXPECT_EQ(status(set_coordinate, 5, 0, -5), Status::success);
  start({instruction(get_axis_parameter, 1), set_variable(0), instruction(get_global_parameter, 66),
         set_variable(1), instruction(get_input, 255), set_variable(2),
         instruction(get_coordinate, 5), set_variable(3), instruction(reference_search, 2),
         set_variable(4), end()});
  pass(11);
  EXPECT_EQ(global(0, 2), 711);
  EXPECT_EQ(global(1, 2), 1);
  EXPECT_EQ(global(2, 2), 0x12);
  EXPECT_EQ(global(3, 2), -5);
  EXPECT_EQ(global(4, 2), 3);
}

TEST_F(InterpreterTest, HostsReadWhileAProgramRunsWithoutDisturbingIt) {
  start({load_constant(5), set_variable(0), instruction(jump_always)});
  module_.position = -9;
  for (int i = 0; i < 30; ++i) {
    pass();
    EXPECT_EQ(axis(1), -9);
    EXPECT_EQ(registers().accumulator, 5);
  }
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 2), Status::success) << "both share everything";
}

TEST_F(InterpreterTest, ConditionsFollowTheLatestComparison) {
  struct Case {
    std::int32_t accumulator;
    std::vector<bool> taken;  ///< ZE NZ EQ NE GT GE LT LE after COMP 1000
  };
  for (const Case& each : {Case{999, {false, true, false, true, false, false, true, true}},
                           Case{1000, {true, false, true, false, false, true, false, true}},
                           Case{1001, {false, true, false, true, true, true, false, false}}}) {
    for (int condition = 0; condition < 8; ++condition) {
      SCOPED_TRACE(testing::Message() << each.accumulator << ", condition " << condition);
      start({load_constant(each.accumulator), instruction(compare, 0, 0, 1000), jump(condition, 4),
             end(), end()});
      pass(4);
      EXPECT_EQ(counter(), each.taken[static_cast<std::size_t>(condition)] ? 4 : 3);
    }
  }
}

TEST_F(InterpreterTest, ComparisonsAreSigned) {
  start({load_constant(-2'147'483'647), instruction(compare, 0, 0, 2'147'483'647), jump(6, 4),
         end(), end()});
  pass(4);
  EXPECT_EQ(counter(), 4);
}

TEST_F(InterpreterTest, ZeroFollowsCalculationsAndReadValuesWhileEqualStays) {
  start({load_constant(3), instruction(compare, 0, 0, 3), instruction(calculate, 1, 0, 2),
         jump(0, 7), jump(2, 5), instruction(get_coordinate, 1), jump(0, 8), end(), end()});
  pass(3);
  EXPECT_FALSE(registers().zero) << "3 - 2";
  EXPECT_TRUE(registers().equal) << "of the comparison";
  pass(5);
  EXPECT_EQ(counter(), 8) << "the coordinate is 0";
}

TEST_F(InterpreterTest, JumpsOutsideTheMemoryAreNotTaken) {
  for (const Command command : {jump_always, call_subroutine}) {
    for (const std::int32_t address : {-1, 2048}) {
      start({instruction(command, 0, 0, address), end()});
      pass(2);
      EXPECT_EQ(counter(), 1);
      EXPECT_EQ(firmware_.interpreter().stack_depth(), 0U);
    }
  }
  start({load_constant(0), jump(0, 2048), end()});
  pass(3);
  EXPECT_EQ(counter(), 2);
}

TEST_F(InterpreterTest, SubroutinesReturnBehindTheirCall) {
  start({instruction(call_subroutine, 0, 0, 3), load_constant(2), end(), load_constant(1),
         instruction(return_from_subroutine)});
  pass();
  EXPECT_EQ(counter(), 3);
  EXPECT_EQ(firmware_.interpreter().stack_depth(), 1U);
  pass(2);
  EXPECT_EQ(counter(), 1);
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(firmware_.interpreter().stack_depth(), 0U);
}

TEST_F(InterpreterTest, TheNinthLevelOfSubroutinesIsPassedOver) {
  std::vector<Instruction> program;
  program.reserve(10);
  for (int level = 0; level < 8; ++level) {
    program.push_back(instruction(call_subroutine, 0, 0, level + 1));
  }
  program.push_back(instruction(call_subroutine, 0, 0, 100));
  program.push_back(end());
  start(program);
  pass(9);
  EXPECT_EQ(counter(), 9) << "the next command";
  EXPECT_EQ(firmware_.interpreter().stack_depth(), 8U);
}

TEST_F(InterpreterTest, AReturnWithoutACallIsPassedOver) {
  start({instruction(return_from_subroutine), load_constant(4), end()});
  pass(3);
  EXPECT_EQ(registers().accumulator, 4);
}

TEST_F(InterpreterTest, ATickIsTenMilliseconds) {
  start({instruction(wait, 0, 0, 500), load_constant(1), end()});
  pass();
  EXPECT_TRUE(firmware_.interpreter().waiting());
  EXPECT_EQ(counter(), 0) << "of the command that waits";
  EXPECT_EQ(firmware_.next_deadline(), now_ + 100_us);
  advance(5_s);
  EXPECT_EQ(registers().accumulator, 0);
  EXPECT_EQ(counter(), 1);
  pass();
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(registers().errors, 0) << "its end is no time-out";
}

TEST_F(InterpreterTest, ConditionsOfWaitLetGoWhenTheyHold) {
  struct Case {
    int type;
    void (*set)(tests::FakeModule&, bool);
  };
  for (const Case& each : {Case{1, [](tests::FakeModule&m, bool on) { m.reached = on; }},
                           Case{2, [](tests::FakeModule&m, bool on) { m.reference_switch = on; }},
                           Case{3, [](tests::FakeModule&m, bool on) { m.limit_switch = on; }},
                           Case{4, [](tests::FakeModule&m, bool on) { m.search = on ? 0 : 2; }}}) {
    SCOPED_TRACE(each.type);
    each.set(module_, false);
    start({instruction(wait, each.type), end()});
    advance(10_s);
    EXPECT_EQ(counter(), 0) << "no time-out";
    each.set(module_, true);
    pass();
    EXPECT_EQ(counter(), 1);
    EXPECT_EQ(registers().errors, 0);
    start({instruction(wait, each.type), end()});
    pass(2);
    EXPECT_EQ(application(), ApplicationStatus::stop) << "held already: takes one pass";
  }
}

TEST_F(InterpreterTest, ATimeOutRaisesEtoAndTheProgramGoesOn) {
  module_.reached = false;
  start({instruction(wait, 1, 0, 3), jump(8, 4), end(), end(), load_constant(7), jump(8, 7), end(),
         instruction(clear_error_flags, 1), jump(8, 0), end()});
  pass();
  advance(29'900_us);
  EXPECT_EQ(counter(), 0);
  advance(100_us);
  EXPECT_EQ(counter(), 1);
  EXPECT_TRUE(registers().raised(ErrorFlag::timeout));
  pass(3);
  EXPECT_EQ(counter(), 7) << "JC does not clear the flag";
  pass(3);
  EXPECT_EQ(counter(), 9) << "CLE does";
  EXPECT_EQ(registers().errors, 0);
}

TEST_F(InterpreterTest, EveryConditionOfWaitMayHaveATimeOut) {
  module_.reached = module_.reference_switch = module_.limit_switch = false;
  module_.search = 2;
  for (const int type : {1, 2, 3, 4}) {
    SCOPED_TRACE(type);
    start({instruction(clear_error_flags, 1), instruction(wait, type, 0, 3), end()});
    pass(2);
    advance(29'900_us);
    EXPECT_EQ(counter(), 1);
    EXPECT_FALSE(registers().raised(ErrorFlag::timeout));
    advance(100_us);
    EXPECT_EQ(counter(), 2);
    EXPECT_TRUE(registers().raised(ErrorFlag::timeout));
  }
}

TEST_F(InterpreterTest, ATimeOutEndsInTimeHoweverFarTimeIsTold) {
  module_.reached = false;
  start({instruction(wait, 1, 0, 3), instruction(calculate, 0, 0, 1),
         instruction(jump_always, 0, 0, 1)});
  advance(31_ms);
  EXPECT_EQ(registers().accumulator, 5) << "every other of the nine passes since 30.1 ms";
}

TEST_F(InterpreterTest, EveryErrorFlagHasItsJumpAndItsClear) {
  constexpr std::array kFlags{ErrorFlag::timeout, ErrorFlag::external_alarm, ErrorFlag::deviation,
                              ErrorFlag::position, ErrorFlag::shutdown};
  for (int i = 0; i < 5; ++i) {
    SCOPED_TRACE(i);
    for (const ErrorFlag flag : kFlags) {
      firmware_.raise(flag);
    }
    start({instruction(clear_error_flags, i + 1), jump(8 + i, 3), end(), end()});
    pass(3);
    EXPECT_EQ(counter(), 2) << "the cleared flag is not seen";
    start({jump(8 + (i + 1) % 5, 2), end(), end()});
    pass(2);
    EXPECT_EQ(counter(), 2) << "others are";
    start({instruction(clear_error_flags, 0), end()});
    pass(2);
    EXPECT_EQ(registers().errors, 0);
  }
}

TEST_F(InterpreterTest, RefusedCommandsChangeNothingAndTheProgramGoesOn) {
  start({instruction(set_axis_parameter, 6, 0, 99), instruction(get_axis_parameter, 200),
         instruction(run_application, 1, 0, 0), instruction(static_cast<Command>(0)),
         instruction(jump_conditionally, 13, 0, 0), instruction(clear_error_flags, 6),
         instruction(wait, 5), instruction(wait, 1, 1), instruction(wait, 0, 0, -1),
         load_constant(6), instruction(calculate, 3, 0, 0), end()});
  pass(12);
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(counter(), 11);
  EXPECT_EQ(registers().accumulator, 6);
  EXPECT_EQ(axis(6), 8);
}

TEST_F(InterpreterTest, ARefusalInALoopIsToldOnceUntilTheNextStart) {
  class Sink : public base::EventSink {
   public:
    void on_event(const base::Event& event) override { sentences.push_back(to_sentence(event)); }
    std::vector<std::string> sentences;
  } sink;
  Firmware firmware(tests::FakeModule::description(), module_, {}, base::EventReporter(&sink, 0));
  firmware.load_program(
      std::vector{instruction(set_axis_parameter, 6, 0, 99), instruction(jump_always)});
  const auto run = [&](base::SimTime now) {
    static_cast<void>(firmware.execute(instruction(run_application, 1), Origin::serial, now));
    firmware.advance(now + 1_s);
  };
  run({});
  ASSERT_EQ(sink.sentences.size(), 1U);
  EXPECT_EQ(sink.sentences[0],
            "program: command SAP at address 0 refused with status 4, with type 6, motor or bank "
            "0, value 99; the program goes on with the next, correct this one");
  run(base::SimTime(1_s));
  EXPECT_EQ(sink.sentences.size(), 2U);
}

TEST_F(InterpreterTest, AProgramWithoutStopRunsIntoTheEmptyMemoryAndEndsWithIt) {
  start({load_constant(1)});
  pass(2047);
  EXPECT_EQ(application(), ApplicationStatus::run);
  EXPECT_EQ(counter(), 2047);
  pass();
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(counter(), 0);
}

TEST_F(InterpreterTest, AWaitInTheLastCellEndsTheProgramToo) {
  std::vector<Instruction> program(2048);
  program[2047] = instruction(wait, 0, 0, 1);
  load(program);
  EXPECT_EQ(status(run_application, 1, 0, 2047), Status::success);
  pass();
  advance(10_ms);
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(counter(), 0);
}

TEST_F(InterpreterTest, RemovingTheReadProtectionErasesTheProgramThatDoesIt) {
  set_global(81, 3);
  start({instruction(set_global_parameter, 81, 0, 0), load_constant(1), end()});
  pass(3);
  EXPECT_EQ(registers().accumulator, 0) << "erased";
  EXPECT_EQ(global(81), 0);
}

}  // namespace
}  // namespace stator::tmcl
