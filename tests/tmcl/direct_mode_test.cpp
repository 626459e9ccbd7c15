// Commands of a host that are executed at once: motion, parameters, coordinates, inputs, outputs.

#include <limits>

#include <gtest/gtest.h>

#include "tmcl/firmware_fixture.hpp"

namespace stator::tmcl {
namespace {

using enum Command;
using DirectMode = tests::FirmwareFixture;

constexpr std::int32_t kLowest = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kHighest = std::numeric_limits<std::int32_t>::max();

TEST_F(DirectMode, RotationIsToTheRightUpwardsAndToTheLeftDownwards) {
  EXPECT_EQ(status(rotate_right, 0, 0, 350), Status::success);
  EXPECT_EQ(module_.velocity, 350);
  EXPECT_EQ(status(rotate_left, 77, 0, 1200), Status::success) << "the type means nothing";
  EXPECT_EQ(module_.velocity, -1200);
  EXPECT_EQ(status(motor_stop), Status::success);
  EXPECT_EQ(module_.velocity, 0);
}

TEST_F(DirectMode, VelocitiesOutOfRangeAreRefused) {
  EXPECT_EQ(status(rotate_right, 0, 0, -1), Status::invalid_value);
  EXPECT_EQ(status(rotate_left, 0, 0, kLowest), Status::invalid_value);
  EXPECT_EQ(status(rotate_right, 0, 0, kHighest), Status::invalid_value)
      << "the module's unit does not reach so far";
  EXPECT_TRUE(module_.velocities.empty());
}

TEST_F(DirectMode, MovesAreAbsoluteRelativeOrToACoordinate) {
  EXPECT_EQ(status(move_to_position, 0, 0, kLowest), Status::success);
  EXPECT_EQ(module_.target, kLowest);
  module_.position = 500;
  EXPECT_EQ(status(move_to_position, 1, 0, -1000), Status::success);
  EXPECT_EQ(module_.target, -500) << "relative to the actual position";
  EXPECT_EQ(status(set_coordinate, 8, 0, 4711), Status::success);
  EXPECT_EQ(status(move_to_position, 2, 0, 8), Status::success);
  EXPECT_EQ(module_.target, 4711);
}

TEST_F(DirectMode, MovesThatLeaveTheRangeDoNotStart) {
  module_.position = kHighest;
  EXPECT_EQ(status(move_to_position, 1, 0, 1), Status::invalid_value);
  module_.position = -2;
  EXPECT_EQ(status(move_to_position, 1, 0, kLowest), Status::invalid_value);
  EXPECT_EQ(status(move_to_position, 2, 0, 21), Status::invalid_value);
  EXPECT_EQ(status(move_to_position, 2, 0, -1), Status::invalid_value);
  EXPECT_EQ(status(move_to_position, 3), Status::wrong_type);
  EXPECT_TRUE(module_.targets.empty());
}

TEST_F(DirectMode, AnotherMotorIsAnInvalidValue) {
  for (const Command command :
       {rotate_right, rotate_left, motor_stop, move_to_position, reference_search, set_coordinate,
        get_coordinate, capture_coordinate, accumulator_to_coordinate}) {
    EXPECT_EQ(status(command, 0, 1), Status::invalid_value)
        << name_of(static_cast<std::uint8_t>(command)).view();
  }
  for (const Command command : {set_axis_parameter, get_axis_parameter, store_axis_parameter,
                                restore_axis_parameter, accumulator_to_axis_parameter}) {
    EXPECT_EQ(status(command, 6, 1, 3), Status::invalid_value);
  }
}

TEST_F(DirectMode, SettingCommandsEchoTheirValueAndReadingOnesCarryWhatWasRead) {
  EXPECT_EQ(execute(move_to_position, 1, 0, -1000).value, -1000);
  EXPECT_EQ(execute(set_axis_parameter, 6, 0, 200).value, 200) << "also when refused";
  module_.position = 711;
  EXPECT_EQ(execute(get_axis_parameter, 1, 0, 5).value, 711);
}

TEST_F(DirectMode, AxisParametersAreCheckedAgainstTheirTable) {
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 15), Status::success);
  EXPECT_EQ(axis(6), 15);
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 16), Status::invalid_value);
  EXPECT_EQ(status(set_axis_parameter, 6, 0, -1), Status::invalid_value);
  EXPECT_EQ(status(set_axis_parameter, 8, 0, 1), Status::wrong_type) << "read only";
  EXPECT_EQ(status(set_axis_parameter, 200, 0, 1), Status::wrong_type) << "unknown";
  EXPECT_EQ(status(get_axis_parameter, 200), Status::wrong_type);
  EXPECT_EQ(status(set_axis_parameter, 128, 0, 1), Status::invalid_value)
      << "in range, but the module does not take it";
  EXPECT_EQ(axis(6), 15);
}

TEST_F(DirectMode, StoringKeepsAnAxisParameterForTheNextStart) {
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 3), Status::success);
  EXPECT_EQ(status(store_axis_parameter, 6), Status::success);
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 12), Status::success);
  EXPECT_EQ(status(set_axis_parameter, 5, 0, 99), Status::success);
  EXPECT_EQ(status(restore_axis_parameter, 6), Status::success);
  EXPECT_EQ(axis(6), 3);
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 12), Status::success);
  module_.power_on();
  EXPECT_EQ(axis(6), 3);
  EXPECT_EQ(axis(5), 50000) << "was not stored";
}

TEST_F(DirectMode, ParametersWithoutLetterEAreStoredButDoNotComeBackAtPowerOn) {
  EXPECT_EQ(status(set_axis_parameter, 128, 0, 2), Status::success);
  EXPECT_EQ(status(store_axis_parameter, 128), Status::success);
  module_.power_on();
  EXPECT_EQ(axis(128), 0);
  EXPECT_EQ(status(restore_axis_parameter, 128), Status::success);
  EXPECT_EQ(axis(128), 2);
  EXPECT_EQ(status(store_axis_parameter, 8), Status::wrong_type) << "read only";
  EXPECT_EQ(status(store_axis_parameter, 34), Status::wrong_type) << "nothing to keep";
  EXPECT_EQ(status(restore_axis_parameter, 34), Status::wrong_type);
}

TEST_F(DirectMode, GlobalParametersOfBank0AreStoredAtOnce) {
  set_global(66, 3);
  EXPECT_EQ(global(66), 3);
  module_.power_on();
  EXPECT_EQ(global(66), 3);
  EXPECT_EQ(status(store_global_parameter, 66), Status::success) << "not needed, no error";
  EXPECT_EQ(status(restore_global_parameter, 66), Status::success);
  EXPECT_EQ(global(66), 3);
}

TEST_F(DirectMode, UserVariablesAreStoredByCommandOnly) {
  set_global(55, -42, 2);
  EXPECT_EQ(global(55, 2), -42);
  module_.power_on();
  EXPECT_EQ(global(55, 2), 0);
  set_global(55, kLowest, 2);
  EXPECT_EQ(status(store_global_parameter, 55, 2), Status::success);
  set_global(55, 1, 2);
  EXPECT_EQ(status(restore_global_parameter, 55, 2), Status::success);
  EXPECT_EQ(global(55, 2), kLowest);
  module_.power_on();
  EXPECT_EQ(global(55, 2), kLowest);
}

TEST_F(DirectMode, UnknownGlobalParametersAndBanksAreWrongTypes) {
  for (const int bank : {1, 3, 255}) {
    EXPECT_EQ(status(get_global_parameter, 0, bank), Status::wrong_type) << bank;
    EXPECT_EQ(status(set_global_parameter, 0, bank), Status::wrong_type) << bank;
    EXPECT_EQ(status(store_global_parameter, 0, bank), Status::wrong_type) << bank;
  }
  for (const int number : {0, 63, 68, 72, 74, 78, 79, 82, 85, 127, 131, 134}) {
    EXPECT_EQ(status(get_global_parameter, number), Status::wrong_type) << number;
  }
  EXPECT_EQ(status(get_global_parameter, 56, 2), Status::wrong_type);
  EXPECT_EQ(status(set_global_parameter, 69, 0, 9), Status::invalid_value);
  for (const int number : {128, 129, 130, 133}) {
    EXPECT_EQ(status(set_global_parameter, number, 0, 0), Status::wrong_type) << number;
    EXPECT_EQ(status(get_global_parameter, number), Status::success) << number;
    EXPECT_EQ(status(store_global_parameter, number), Status::wrong_type) << number;
  }
}

TEST_F(DirectMode, TheLockKeepsTheEepromFromBeingWritten) {
  set_global(73, kLockEeprom);
  EXPECT_EQ(global(73), 1);
  EXPECT_EQ(status(store_axis_parameter, 6), Status::eeprom_locked);
  EXPECT_EQ(status(store_global_parameter, 3, 2), Status::eeprom_locked);
  EXPECT_EQ(status(store_global_parameter, 66), Status::eeprom_locked);
  EXPECT_EQ(status(set_global_parameter, 66, 0, 5), Status::eeprom_locked);
  EXPECT_EQ(status(set_global_parameter, 66, 0, 256), Status::invalid_value);
  EXPECT_EQ(global(66), 1);
  EXPECT_EQ(status(set_axis_parameter, 6, 0, 5), Status::success) << "RAM is not locked";
  EXPECT_EQ(status(set_global_parameter, 3, 2, 5), Status::success);
  EXPECT_EQ(status(set_global_parameter, 132, 0, 0), Status::success);
  EXPECT_EQ(status(restore_axis_parameter, 6), Status::success);
  module_.power_on();
  EXPECT_EQ(global(73), 1) << "the lock is kept too";
  EXPECT_EQ(status(set_global_parameter, 73, 0, 1), Status::invalid_value);
  set_global(73, kUnlockEeprom);
  EXPECT_EQ(global(73), 0);
  EXPECT_EQ(status(store_axis_parameter, 6), Status::success);
}

TEST_F(DirectMode, TheTickTimerCountsMillisecondsAndCanBePreset) {
  now_ += base::SimDuration(1'999'999);
  EXPECT_EQ(global(132), 1);
  set_global(132, kHighest);
  now_ += base::SimDuration(1'000'000);
  EXPECT_EQ(global(132), kLowest) << "wraps";
  EXPECT_EQ(global(128), 0);
}

TEST_F(DirectMode, RandomNumbersAreNewOnesAndNotNegative) {
  const std::int32_t first = global(133);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const std::int32_t number = global(133);
    EXPECT_GE(number, 0);
    differs = differs || number != first;
  }
  EXPECT_TRUE(differs);
  firmware_.power_on(now_);
  EXPECT_NE(global(133), first) << "also after switching on";
}

TEST_F(DirectMode, CoordinatesAreSetReadAndCaptured) {
  EXPECT_EQ(status(set_coordinate, 20, 0, kLowest), Status::success);
  EXPECT_EQ(execute(get_coordinate, 20).value, kLowest);
  module_.position = 90000;
  EXPECT_EQ(status(capture_coordinate, 3), Status::success);
  EXPECT_EQ(execute(get_coordinate, 3).value, 90000);
  EXPECT_EQ(status(calculate, 9, 0, -8), Status::success);
  EXPECT_EQ(status(accumulator_to_coordinate, 4), Status::success);
  EXPECT_EQ(execute(get_coordinate, 4).value, -8);
  for (const Command command :
       {set_coordinate, get_coordinate, capture_coordinate, accumulator_to_coordinate}) {
    EXPECT_EQ(status(command, 21), Status::wrong_type);
  }
}

TEST_F(DirectMode, CoordinatesReachTheEepromByCommandOrByParameter84) {
  const auto stored = [this](std::uint8_t number) {
    module_.restore_coordinate(number);
    return module_.coordinate(number);
  };
  EXPECT_EQ(status(set_coordinate, 1, 0, 11), Status::success);
  EXPECT_EQ(stored(1), 0) << "RAM only";
  set_global(84, 1);
  EXPECT_EQ(status(set_coordinate, 0, 0, 10), Status::success);
  EXPECT_EQ(status(set_coordinate, 1, 0, 11), Status::success);
  EXPECT_EQ(stored(1), 11);
  EXPECT_EQ(stored(0), 0) << "is never kept";
  set_global(84, 0);
  EXPECT_EQ(status(set_coordinate, 2, 0, 22), Status::success);
  EXPECT_EQ(status(set_coordinate, 3, 0, 33), Status::success);
  EXPECT_EQ(status(set_coordinate, 2, 255), Status::success);
  EXPECT_EQ(status(set_coordinate, 2, 0, 0), Status::success);
  EXPECT_EQ(execute(get_coordinate, 2, 255).value, 22) << "copied back";
  EXPECT_EQ(execute(get_coordinate, 2).value, 22);
  EXPECT_EQ(status(set_coordinate, 0, 255), Status::success) << "all but coordinate 0";
  EXPECT_EQ(stored(3), 33);
}

TEST_F(DirectMode, OutputsAreSetOneByOneOrTogether) {
  EXPECT_EQ(status(set_output, 7, 2, 1), Status::success);
  EXPECT_EQ(status(set_output, 1, 2, 1), Status::success);
  EXPECT_EQ(module_.outputs, 0x82U);
  EXPECT_EQ(status(set_output, 7, 2, 0), Status::success);
  EXPECT_EQ(module_.outputs, 0x02U);
  EXPECT_EQ(status(set_output, 255, 2, 255), Status::success);
  EXPECT_EQ(module_.outputs, 0x87U) << "bits of outputs that do not exist mean nothing";
  EXPECT_EQ(status(calculate, 9, 0, 0x7F05), Status::success);
  EXPECT_EQ(status(set_output, 255, 2, -1), Status::success);
  EXPECT_EQ(module_.outputs, 0x05U) << "the low byte of the accumulator";
  EXPECT_EQ(execute(get_input, 2, 2).value, 1);
  EXPECT_EQ(execute(get_input, 1, 2).value, 0);
}

TEST_F(DirectMode, PortsThatDoNotExistAreWrongTypes) {
  EXPECT_EQ(status(set_output, 3, 2, 1), Status::wrong_type);
  EXPECT_EQ(status(set_output, 40, 2, 1), Status::wrong_type);
  EXPECT_EQ(status(set_output, 0, 0, 1), Status::wrong_type) << "bank 0 is for inputs";
  EXPECT_EQ(status(set_output, 0, 2, 2), Status::invalid_value);
  EXPECT_EQ(status(set_output, 255, 2, 256), Status::invalid_value);
  EXPECT_EQ(status(set_output, 255, 2, -2), Status::invalid_value);
  EXPECT_EQ(module_.outputs, 0U);
  EXPECT_EQ(status(get_input, 9, 0), Status::wrong_type);
  EXPECT_EQ(status(get_input, 3, 1), Status::wrong_type);
  EXPECT_EQ(status(get_input, 3, 2), Status::wrong_type);
  EXPECT_EQ(status(get_input, 0, 3), Status::wrong_type);
  EXPECT_EQ(status(get_input, 255, 1), Status::wrong_type);
}

TEST_F(DirectMode, InputsAreReadAsBitsAndAsVoltages) {
  module_.inputs = 0x101;
  module_.analog = {506, 1023, 0};
  EXPECT_EQ(execute(get_input, 0, 0).value, 1);
  EXPECT_EQ(execute(get_input, 1, 0).value, 0);
  EXPECT_EQ(execute(get_input, 8, 0).value, 1);
  EXPECT_EQ(execute(get_input, 255, 0).value, 0x101) << "input 8 in bit 8";
  EXPECT_EQ(execute(get_input, 0, 1).value, 506) << "the same line as input 0";
  EXPECT_EQ(execute(get_input, 1, 1).value, 1023);
}

TEST_F(DirectMode, AModuleMayShowEightBitsOfItsInputs) {
  ModuleDescription description = tests::FakeModule::description();
  description.input_bits = 0xFF;
  Firmware firmware(description, module_);
  module_.inputs = 0x1FF;
  EXPECT_EQ(firmware.execute(tests::instruction(get_input, 255), Origin::serial, now_).value, 0xFF);
}

TEST_F(DirectMode, AReferenceSearchIsStartedAskedForAndStopped) {
  EXPECT_EQ(execute(reference_search, 2).value, 0);
  EXPECT_EQ(status(reference_search, 0), Status::success);
  EXPECT_NE(execute(reference_search, 2).value, 0);
  EXPECT_EQ(status(reference_search, 1), Status::success);
  EXPECT_EQ(execute(reference_search, 2).value, 0);
  EXPECT_EQ(status(reference_search, 3), Status::wrong_type);
}

TEST_F(DirectMode, ReadingCommandsLeaveTheAccumulatorToTheProgram) {
  EXPECT_EQ(status(calculate, 9, 0, 1234), Status::success);
  module_.position = 711;
  EXPECT_EQ(axis(1), 711);
  EXPECT_EQ(global(66), 1);
  EXPECT_EQ(status(get_coordinate, 1), Status::success);
  EXPECT_EQ(status(get_input, 0), Status::success);
  EXPECT_EQ(registers().accumulator, 1234);
}

TEST_F(DirectMode, CalculationsActOnTheOneAccumulator) {
  EXPECT_EQ(status(calculate, 9, 0, 7), Status::success);
  EXPECT_EQ(status(calculate_with_x, 9), Status::success);
  EXPECT_EQ(status(calculate, 2, 0, -5000), Status::success);
  EXPECT_EQ(registers().accumulator, -35000);
  EXPECT_EQ(registers().x, 7);
  EXPECT_EQ(status(calculate, 9, 0, 12), Status::success);
  EXPECT_EQ(status(accumulator_to_axis_parameter, 6), Status::success);
  EXPECT_EQ(axis(6), 12);
  EXPECT_EQ(status(accumulator_to_global_parameter, 3, 2), Status::success);
  EXPECT_EQ(global(3, 2), 12);
  EXPECT_EQ(status(calculate, 0, 0, 4), Status::success);
  EXPECT_EQ(status(accumulator_to_axis_parameter, 6), Status::invalid_value);
  EXPECT_EQ(status(accumulator_to_axis_parameter, 8), Status::wrong_type);
}

TEST_F(DirectMode, WhatControlsProgramsIsNotAvailable) {
  for (const Command command : {compare, jump_conditionally, jump_always, call_subroutine,
                                return_from_subroutine, wait, Command::stop, clear_error_flags}) {
    EXPECT_EQ(status(command), Status::command_not_available)
        << name_of(static_cast<std::uint8_t>(command)).view();
  }
  EXPECT_EQ(counter(), 0);
}

TEST_F(DirectMode, NumbersWithoutACommandAreInvalid) {
  for (const int number :
       {0, 16, 17, 18, 25, 26, 29, 37, 38, 40, 63, 72, 127, 140, 200, 242, 255}) {
    EXPECT_EQ(status(static_cast<Command>(number)), Status::invalid_command) << number;
  }
}

TEST_F(DirectMode, UserFunctionsDoNothingAsDelivered) {
  for (int n = 64; n < 72; ++n) {
    const HostAnswer answer = execute(static_cast<Command>(n), 9, 8, -7);
    EXPECT_EQ(answer.status, Status::success);
    EXPECT_EQ(answer.value, -7);
  }
}

}  // namespace
}  // namespace stator::tmcl
