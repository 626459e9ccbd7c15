// Control functions of hosts: run, stop, step, reset, download, read back, version, defaults.

#include <gtest/gtest.h>

#include "tmcl/firmware_fixture.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using enum Command;
using tests::instruction;
using ApplicationControl = tests::FirmwareFixture;

const std::vector<Instruction>& counting_loop() {
  static const std::vector<Instruction> program{
      instruction(calculate, 0, 0, 1), instruction(calculate, 0, 0, 1), instruction(jump_always)};
  return program;
}

TEST_F(ApplicationControl, StopKeepsThePlaceAndRunGoesOnThere) {
  start(counting_loop());
  pass(4);
  EXPECT_EQ(execute(get_application_status).value, 1);
  EXPECT_EQ(global(128), 1);
  EXPECT_EQ(status(stop_application), Status::success);
  EXPECT_EQ(execute(get_application_status).value, 0);
  EXPECT_EQ(global(130), 1);
  advance(1_s);
  EXPECT_EQ(registers().accumulator, 3);
  EXPECT_EQ(status(run_application, 0), Status::success);
  pass();
  EXPECT_EQ(registers().accumulator, 4);
  EXPECT_EQ(counter(), 2);
}

TEST_F(ApplicationControl, RunWhileRunningChangesNothing) {
  start(counting_loop());
  now_ += 50_us;
  EXPECT_EQ(status(run_application, 0), Status::success);
  advance(50_us);
  EXPECT_EQ(registers().accumulator, 1) << "the pass comes when it would have come";
}

TEST_F(ApplicationControl, RunFromAnAddressBeginsThereWithAnEmptyStack) {
  load({instruction(call_subroutine, 0, 0, 0), instruction(calculate, 9, 0, 9),
        instruction(return_from_subroutine), instruction(Command::stop)});
  EXPECT_EQ(status(run_application, 1, 0, 0), Status::success);
  pass(5);
  EXPECT_EQ(firmware_.interpreter().stack_depth(), 5U);
  EXPECT_EQ(status(run_application, 1, 0, 1), Status::success);
  pass(3);
  EXPECT_EQ(application(), ApplicationStatus::stop);
  EXPECT_EQ(registers().accumulator, 9);
  EXPECT_EQ(status(run_application, 1, 0, 2048), Status::invalid_value);
  EXPECT_EQ(status(run_application, 1, 0, -1), Status::invalid_value);
  EXPECT_EQ(status(run_application, 2), Status::wrong_type);
}

TEST_F(ApplicationControl, StepExecutesOneInstructionAtOnce) {
  load(counting_loop());
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(execute(get_application_status).value, 2);
  advance(1_s);
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(registers().accumulator, 2);
  EXPECT_EQ(counter(), 0) << "the jump was the third";
  EXPECT_EQ(status(run_application), Status::success);
  pass();
  EXPECT_EQ(status(step_application), Status::success) << "also of a running program";
  EXPECT_EQ(application(), ApplicationStatus::step);
  EXPECT_EQ(registers().accumulator, 4);
}

TEST_F(ApplicationControl, AStepOverAWaitLastsAsLongAsTheWait) {
  load({instruction(wait, 0, 0, 2), instruction(calculate, 9, 0, 1), instruction(Command::stop)});
  EXPECT_EQ(status(step_application), Status::success);
  advance(10_ms);
  EXPECT_EQ(status(step_application), Status::success) << "has nothing to do";
  EXPECT_EQ(counter(), 0);
  advance(10_ms);
  EXPECT_EQ(counter(), 1);
  advance(1_s);
  EXPECT_EQ(registers().accumulator, 0);
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(registers().accumulator, 1);
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(application(), ApplicationStatus::stop) << "STOP";
}

TEST_F(ApplicationControl, AStoppedWaitBeginsAnew) {
  start({instruction(wait, 0, 0, 2), instruction(Command::stop)});
  advance(15_ms);
  EXPECT_EQ(status(stop_application), Status::success);
  EXPECT_EQ(status(run_application), Status::success);
  advance(20_ms);
  EXPECT_EQ(counter(), 0);
  pass();
  EXPECT_EQ(counter(), 1);
}

TEST_F(ApplicationControl, ResetClearsCounterAndStackOnly) {
  start({instruction(calculate, 9, 0, 5), instruction(call_subroutine, 0, 0, 1)});
  pass(4);
  firmware_.raise(ErrorFlag::shutdown);
  EXPECT_EQ(status(reset_application), Status::success);
  EXPECT_EQ(execute(get_application_status).value, 3);
  EXPECT_EQ(counter(), 0);
  EXPECT_EQ(firmware_.interpreter().stack_depth(), 0U);
  EXPECT_EQ(registers().accumulator, 5);
  EXPECT_TRUE(registers().raised(ErrorFlag::shutdown));
  advance(1_s);
  EXPECT_EQ(counter(), 0);
}

TEST_F(ApplicationControl, PowerOnBeginsWithEmptyRegistersAndAStoppedProgram) {
  start(counting_loop());
  pass(5);
  firmware_.raise(ErrorFlag::timeout);
  firmware_.power_on(now_);
  EXPECT_EQ(registers(), Registers{});
  EXPECT_EQ(counter(), 0);
  EXPECT_EQ(global(128), 0);
  advance(1_s);
  EXPECT_EQ(registers().accumulator, 0);
  EXPECT_EQ(firmware_.memory()[0], counting_loop()[0]) << "the program survives";
}

TEST_F(ApplicationControl, AutoStartRunsTheProgramAtPowerOn) {
  load(counting_loop());
  set_global(77, 1);
  firmware_.power_on(now_);
  EXPECT_EQ(global(128), 1);
  pass();
  EXPECT_EQ(registers().accumulator, 1);
}

TEST_F(ApplicationControl, DownloadStoresCommandsInsteadOfExecutingThem) {
  EXPECT_EQ(status(start_download, 0, 0, 10), Status::success);
  EXPECT_EQ(global(129), 0) << "GGP was stored, not executed";
  EXPECT_TRUE(firmware_.state().download);
  const HostAnswer answer = execute(rotate_left, 0, 0, 500'000);
  EXPECT_EQ(answer.status, Status::loaded_into_eeprom);
  EXPECT_EQ(answer.value, 500'000);
  EXPECT_EQ(status(Command::stop), Status::loaded_into_eeprom);
  EXPECT_EQ(status(static_cast<Command>(0)), Status::loaded_into_eeprom) << "whatever it is";
  EXPECT_EQ(status(request_target_reached_event), Status::loaded_into_eeprom);
  EXPECT_TRUE(module_.velocities.empty());
  EXPECT_EQ(status(quit_download), Status::success);
  EXPECT_EQ(global(129), 0);
  EXPECT_EQ(firmware_.memory()[10], instruction(get_global_parameter, 129));
  EXPECT_EQ(firmware_.memory()[11], instruction(rotate_left, 0, 0, 500'000));
  EXPECT_EQ(firmware_.memory()[12], instruction(Command::stop));
  EXPECT_EQ(firmware_.memory()[9], Instruction{});
  EXPECT_EQ(status(rotate_left, 0, 0, 1), Status::success) << "executed again";
}

// A host cannot read it meanwhile, since that command is stored; a program can.
TEST_F(ApplicationControl, DownloadModeShowsInItsParameter) {
  load({instruction(get_global_parameter, 129), instruction(Command::stop)});
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(registers().accumulator, 0);
  EXPECT_EQ(status(reset_application), Status::success);
  EXPECT_EQ(status(start_download, 0, 0, 100), Status::success);
  EXPECT_EQ(status(step_application), Status::success);
  EXPECT_EQ(registers().accumulator, 1);
}

TEST_F(ApplicationControl, ControlFunctionsAreExecutedInDownloadMode) {
  EXPECT_EQ(status(start_download), Status::success);
  EXPECT_EQ(status(get_application_status), Status::success);
  EXPECT_EQ(execute(get_firmware_version, 1).value, 4 << 8 | 45);
  EXPECT_EQ(execute(read_memory).form, ReplyForm::instruction);
  EXPECT_EQ(status(motor_stop), Status::loaded_into_eeprom);
  EXPECT_EQ(firmware_.memory()[0], instruction(motor_stop)) << "none of the others was stored";
}

TEST_F(ApplicationControl, ADownloadEndsWithTheMemory) {
  EXPECT_EQ(status(start_download, 0, 0, 2048), Status::invalid_value);
  EXPECT_EQ(status(start_download, 0, 0, -1), Status::invalid_value);
  EXPECT_FALSE(firmware_.state().download);
  EXPECT_EQ(status(start_download, 0, 0, 2047), Status::success);
  EXPECT_EQ(status(motor_stop), Status::loaded_into_eeprom);
  EXPECT_EQ(status(motor_stop), Status::invalid_value) << "not stored";
  EXPECT_EQ(firmware_.memory()[2047], instruction(motor_stop));
  EXPECT_EQ(firmware_.memory()[0], Instruction{});
}

TEST_F(ApplicationControl, ADownloadStopsTheProgram) {
  start(counting_loop());
  pass();
  EXPECT_EQ(status(start_download), Status::success);
  EXPECT_EQ(application(), ApplicationStatus::stop);
}

TEST_F(ApplicationControl, TheMemoryIsReadBackCellByCell) {
  load(counting_loop());
  for (std::int32_t i = 0; i < 3; ++i) {
    const HostAnswer answer = execute(read_memory, 0, 0, i);
    EXPECT_EQ(answer.form, ReplyForm::instruction);
    EXPECT_EQ(answer.instruction, counting_loop()[static_cast<std::size_t>(i)]);
  }
  EXPECT_EQ(execute(read_memory, 0, 0, 2047).instruction, Instruction{}) << "unused";
  EXPECT_EQ(status(read_memory, 0, 0, 2048), Status::invalid_value);
  EXPECT_EQ(status(read_memory, 0, 0, -1), Status::invalid_value);
}

TEST_F(ApplicationControl, CodeProtectionKeepsTheProgramFromBeingReadOrWritten) {
  load(counting_loop());
  for (const std::int32_t protection : {0, 1, 2, 3}) {
    SCOPED_TRACE(protection);
    load(counting_loop());
    set_global(81, protection);
    EXPECT_EQ(status(read_memory),
              protection == 1 || protection == 3 ? Status::command_not_available : Status::success);
    EXPECT_EQ(status(start_download),
              protection >= 2 ? Status::command_not_available : Status::success);
    EXPECT_EQ(status(quit_download), Status::success);
  }
}

TEST_F(ApplicationControl, EndingTheProtectionFromReadingErasesTheProgram) {
  struct Case {
    int before;
    int after;
    bool erased;
  };
  for (const Case& each :
       {Case{1, 0, true}, Case{1, 2, true}, Case{3, 0, true}, Case{3, 2, true}, Case{1, 3, false},
        Case{3, 1, false}, Case{2, 0, false}, Case{0, 1, false}, Case{2, 3, false}}) {
    SCOPED_TRACE(testing::Message() << each.before << " to " << each.after);
    set_global(81, each.before);
    load(counting_loop());
    const auto writes = firmware_.memory().write_count();
    set_global(81, each.after);
    EXPECT_EQ(firmware_.memory()[0], each.erased ? Instruction{} : counting_loop()[0]);
    EXPECT_EQ(firmware_.memory().write_count() > writes, each.erased);
  }
}

TEST_F(ApplicationControl, TheVersionIsATextOrANumber) {
  EXPECT_EQ(execute(get_firmware_version, 0).form, ReplyForm::version_text);
  const HostAnswer number = execute(get_firmware_version, 1);
  EXPECT_EQ(number.form, ReplyForm::normal);
  EXPECT_EQ(number.value, 0x042D) << "4.45, the low byte first";
  EXPECT_EQ(status(get_firmware_version, 2), Status::wrong_type);
}

// T-11: hosts wait for none.
TEST_F(ApplicationControl, CommandsOfABootLoaderHaveNoReplyAlsoInDownloadMode) {
  for (const bool download : {false, true}) {
    if (download) {
      ASSERT_EQ(status(start_download, 0, 0, 7), Status::success);
    }
    for (const Command command : {boot, boot_start_application}) {
      const HostAnswer answer = execute(command, 0x81, 0x92, static_cast<int>(0xA3B4C5D6));
      EXPECT_EQ(answer.form, ReplyForm::none);
      EXPECT_EQ(answer.status, Status::invalid_command) << "for people: it was not obeyed";
    }
    EXPECT_EQ(execute(boot_get_info).form, ReplyForm::normal) << "the boot loader's own have one";
  }
  EXPECT_EQ(status(quit_download), Status::success);
  EXPECT_EQ(firmware_.memory()[7].command, static_cast<std::uint8_t>(boot_get_info))
      << "neither was stored";
}

TEST_F(ApplicationControl, FactorySettingsNeedTheirNumberAndHaveNoReply) {
  set_global(66, 9);
  EXPECT_EQ(status(restore_factory_settings, 0, 0, 1233), Status::invalid_value);
  EXPECT_EQ(module_.factory_resets, 0);
  const HostAnswer answer = execute(restore_factory_settings, 0, 0, 1234);
  EXPECT_EQ(answer.form, ReplyForm::none);
  EXPECT_EQ(global(66), 9) << "felt at the next start";
  module_.power_on();
  EXPECT_EQ(global(66), 1);
}

TEST_F(ApplicationControl, ProgramsMayNotUseControlFunctions) {
  for (int n = 128; n < 140; ++n) {
    load({instruction(static_cast<Command>(n), 0, 0, 1234), instruction(calculate, 9, 0, n),
          instruction(Command::stop)});
    EXPECT_EQ(status(run_application, 1), Status::success);
    pass(3);
    EXPECT_EQ(application(), ApplicationStatus::stop);
    EXPECT_EQ(registers().accumulator, n);
    EXPECT_FALSE(firmware_.state().download);
  }
  EXPECT_EQ(module_.factory_resets, 0);
}

TEST_F(ApplicationControl, AsciiModeIsForSerialLines) {
  EXPECT_TRUE(execute(enter_ascii_mode).enter_ascii);
  const HostAnswer answer = execute(enter_ascii_mode, 0, 0, 0, Origin::can);
  EXPECT_EQ(answer.status, Status::command_not_available);
  EXPECT_FALSE(answer.enter_ascii);
}

}  // namespace
}  // namespace stator::tmcl
