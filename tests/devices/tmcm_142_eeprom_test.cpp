// What a TMCM-142 keeps without supply.

#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "tmcm_142_memory.hpp"
#include "tmcm_142_module.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

constexpr int kMagic = 64;
constexpr int kAddress = 66;
constexpr int kLock = 73;
constexpr int kAutoStart = 77;
constexpr int kCoordinateStorage = 84;
constexpr int kVariables = 2;  // a bank

struct Tmcm142Eeprom : testing::Test {
  Tmcm142Module module;
  Status stap(int parameter) {
    return module.execute(Command::store_axis_parameter, parameter, 0).status;
  }
  Status rsap(int parameter) {
    return module.execute(Command::restore_axis_parameter, parameter, 0).status;
  }
};

TEST_F(Tmcm142Eeprom, EveryStoredParameterComesBackAtPowerOn) {
  const auto parameters = devices::tmcm_142::axis_parameters();
  std::map<int, std::int32_t> wanted;
  for (const tmcl::ParameterDeclaration& parameter : parameters) {
    if (!parameter.stored || parameter.number == 255) {
      continue;
    }
    // 5 writes 16 and 17, which come after it; 42 has a value that no mode refuses.
    const std::int32_t value =
        parameter.initial == parameter.maximum ? parameter.minimum : parameter.initial + 1;
    EXPECT_EQ(module.execute(Command::set_axis_parameter, parameter.number, 0, value).status,
              Status::success)
        << int{parameter.number};
    EXPECT_EQ(stap(parameter.number), Status::success) << int{parameter.number};
    wanted[parameter.number] = value;
  }
  wanted[5] = wanted[16];
  module.power_cycle();
  for (const auto& [number, value] : wanted) {
    EXPECT_EQ(module.execute(Command::get_axis_parameter, number, 0).value, value) << number;
  }
}

TEST_F(Tmcm142Eeprom, WhatIsNotStoredIsLost) {
  ASSERT_EQ(module.sap(max_current, 3), Status::success);
  module.power_cycle();
  EXPECT_EQ(module.gap(max_current), 8);
}

TEST_F(Tmcm142Eeprom, AStoredValueIsRestoredByCommand) {
  ASSERT_EQ(module.sap(bow, 5), Status::success);
  ASSERT_EQ(stap(18), Status::success);
  ASSERT_EQ(module.sap(bow, 9), Status::success);
  ASSERT_EQ(rsap(18), Status::success);
  EXPECT_EQ(module.gap(bow), 5);
}

TEST_F(Tmcm142Eeprom, BothAccelerationsAreStoredAndRestoredByTheirCommonParameter) {
  ASSERT_EQ(module.sap(max_acceleration_and_deceleration, 4'321), Status::success);
  ASSERT_EQ(stap(5), Status::success);
  ASSERT_EQ(module.sap(max_acceleration, 1), Status::success);
  ASSERT_EQ(module.sap(max_deceleration, 2), Status::success);
  ASSERT_EQ(rsap(5), Status::success);
  EXPECT_EQ(module.gap(max_acceleration), 4'321);
  EXPECT_EQ(module.gap(max_deceleration), 4'321);
  module.power_cycle();
  EXPECT_EQ(module.gap(max_acceleration_and_deceleration), 4'321);
  EXPECT_EQ(module.gap(max_deceleration), 4'321);
}

// A56: STAP and RSAP take them, power-on does not.
TEST_F(Tmcm142Eeprom, PositionsAreStorableAndNotRestoredAtPowerOn) {
  ASSERT_EQ(module.execute(Command::rotate_right, 0, 0, 0).status, Status::success);
  ASSERT_EQ(module.sap(actual_position, 777), Status::success);
  ASSERT_EQ(stap(1), Status::success);
  ASSERT_EQ(module.sap(actual_position, 1), Status::success);
  ASSERT_EQ(rsap(1), Status::success);
  EXPECT_EQ(module.gap(actual_position), 777);
  for (const int parameter : {0, 2, 3, 63, 128}) {
    EXPECT_EQ(stap(parameter), Status::success) << parameter;
  }
  module.power_cycle();
  EXPECT_EQ(module.gap(actual_position), 0);
  EXPECT_EQ(module.gap(target_position), 0);
  EXPECT_EQ(module.gap(ramp_mode), 0);
}

// A54: the EEPROM has the chip's units, whichever the user's are.
TEST_F(Tmcm142Eeprom, KeepsUnitsOfTheChip) {
  ASSERT_EQ(module.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module.sap(max_positioning_speed, 14'901), Status::success);
  ASSERT_EQ(stap(4), Status::success);
  module.power_cycle();
  ASSERT_EQ(module.gap(unit_conversion_mode), 0);
  EXPECT_NEAR(module.gap(max_positioning_speed), 1'000'000, 34);
}

TEST_F(Tmcm142Eeprom, ThePositionStartsFromZeroWhereverTheShaftIs) {
  ASSERT_EQ(module.execute(Command::move_to_position, 0, 0, 20'480).status, Status::success);
  ASSERT_TRUE(module.run_to_target(5_s));
  module.run(100_ms);
  module.power_cycle();
  EXPECT_EQ(module.gap(actual_position), 0);
  EXPECT_NEAR(module.signal("axis0.shaft_position"), 0.1, 2e-3);
}

TEST_F(Tmcm142Eeprom, GlobalParametersAreKeptAtOnceAndVariablesWhenStored) {
  ASSERT_EQ(module.sgp(kAddress, 7), Status::success);
  ASSERT_EQ(module.sgp(3, 33, kVariables), Status::success);
  ASSERT_EQ(module.execute(Command::store_global_parameter, 3, kVariables).status, Status::success);
  ASSERT_EQ(module.sgp(3, 44, kVariables), Status::success);
  ASSERT_EQ(module.sgp(4, 55, kVariables), Status::success);
  module.power_cycle();
  EXPECT_EQ(module.ggp(kAddress), 7);
  EXPECT_EQ(module.ggp(3, kVariables), 33);
  EXPECT_EQ(module.ggp(4, kVariables), 0);
}

TEST_F(Tmcm142Eeprom, TheTelegramPauseIsKeptBySettingItAlone) {
  constexpr int kTelegramPause = 75;
  ModuleMemory memory;
  module.device->connect_memory(memory);
  const int before = memory.orders;
  ASSERT_EQ(module.ggp(kTelegramPause), 0);
  ASSERT_EQ(module.sgp(kTelegramPause, 15), Status::success);
  module.run(20_ms);
  EXPECT_GT(memory.orders, before) << "no other command was needed";
  module.power_cycle();
  EXPECT_EQ(module.ggp(kTelegramPause), 15);

  Tmcm142Module other;
  other.device->connect_memory(memory);
  EXPECT_EQ(other.ggp(kTelegramPause), 15) << "in the EEPROM, wherever it is put";
}

TEST_F(Tmcm142Eeprom, VariablesAreFiftySixSignedNumbers) {
  for (int i = 0; i < 56; ++i) {
    EXPECT_EQ(module.sgp(i, -2'147'483'648LL + i, kVariables), Status::success) << i;
  }
  for (int i = 0; i < 56; ++i) {
    EXPECT_EQ(module.ggp(i, kVariables), -2'147'483'648LL + i) << i;
  }
  EXPECT_EQ(module.sgp(56, 0, kVariables), Status::wrong_type);
  EXPECT_EQ(module.sgp(255, 0, kVariables), Status::wrong_type);
}

TEST_F(Tmcm142Eeprom, AnotherMagicRestoresEverythingAtTheNextStart) {
  ASSERT_EQ(module.sgp(kAddress, 7), Status::success);
  ASSERT_EQ(module.sap(bow, 5), Status::success);
  ASSERT_EQ(stap(18), Status::success);
  ASSERT_EQ(module.sgp(0, 9, kVariables), Status::success);
  ASSERT_EQ(module.execute(Command::store_global_parameter, 0, kVariables).status, Status::success);
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>(3, {.command = 28}));
  ASSERT_EQ(module.sgp(kMagic, 0), Status::success);
  EXPECT_EQ(module.ggp(kAddress), 7) << "not before the next start";
  module.power_cycle();
  EXPECT_EQ(module.ggp(kMagic), 0xE4);
  EXPECT_EQ(module.ggp(kAddress), 1);
  EXPECT_EQ(module.gap(bow), 0);
  EXPECT_EQ(module.ggp(0, kVariables), 0);
  EXPECT_EQ(module.device->tmcl().memory()[0], tmcl::Instruction{});
  EXPECT_EQ(module.events.count("magic"), 1);
}

TEST_F(Tmcm142Eeprom, FactorySettingsComeBackAtTheNextStart) {
  ASSERT_EQ(module.sap(bow, 5), Status::success);
  ASSERT_EQ(stap(18), Status::success);
  EXPECT_EQ(module.execute(Command::restore_factory_settings, 0, 0, 1234).form,
            tmcl::ReplyForm::none);
  EXPECT_EQ(module.gap(bow), 5);
  module.power_cycle();
  EXPECT_EQ(module.gap(bow), 0);
}

TEST_F(Tmcm142Eeprom, CoordinatesAreKeptIfTheirParameterSaysSo) {
  const auto set = [&](int number, int value) {
    return module.execute(Command::set_coordinate, number, 0, value).status;
  };
  const auto get = [&](int number) {
    return module.execute(Command::get_coordinate, number, 0).value;
  };
  ASSERT_EQ(set(1, 100), Status::success);
  module.power_cycle();
  EXPECT_EQ(get(1), 0);
  ASSERT_EQ(module.sgp(kCoordinateStorage, 1), Status::success);
  ASSERT_EQ(set(0, 99), Status::success);
  ASSERT_EQ(set(1, 100), Status::success);
  ASSERT_EQ(set(20, 120), Status::success);
  module.power_cycle();
  EXPECT_EQ(get(0), 0) << "in RAM only";
  EXPECT_EQ(get(1), 100);
  EXPECT_EQ(get(20), 120);
}

TEST_F(Tmcm142Eeprom, TheLockIsKept) {
  ASSERT_EQ(module.sgp(kLock, 1234), Status::success);
  module.power_cycle();
  EXPECT_EQ(module.ggp(kLock), 1);
  EXPECT_EQ(stap(18), Status::eeprom_locked);
  EXPECT_EQ(module.sgp(kAddress, 3), Status::eeprom_locked);
  EXPECT_EQ(module.sgp(kLock, 4321), Status::success);
  EXPECT_EQ(stap(18), Status::success);
}

TEST_F(Tmcm142Eeprom, AProgramStartsWithTheModuleIfToldSo) {
  const std::vector<tmcl::Instruction> program{{.command = 14, .type = 1, .motor = 2, .value = 1},
                                               {.command = 28}};
  module.device->tmcl().load_program(program);
  ASSERT_EQ(module.sgp(kAutoStart, 1), Status::success);
  module.power_cycle();
  EXPECT_EQ(module.signal("output1"), 0.0);
  module.run(1_ms);
  EXPECT_EQ(module.signal("output1"), 1.0);
  EXPECT_EQ(module.signal("program_status"), 0.0);
}

TEST(Tmcm142Memory, OutlivesTheDevice) {
  ModuleMemory memory;
  {
    Tmcm142Module module;
    module.device->connect_memory(memory);
    ASSERT_EQ(module.sgp(kAddress, 9), Status::success);
    ASSERT_EQ(module.sap(bow, 5), Status::success);
    ASSERT_EQ(module.execute(Command::store_axis_parameter, 18, 0).status, Status::success);
    module.device->tmcl().load_program(
        std::vector<tmcl::Instruction>{{.command = 1, .value = -70'000}, {.command = 28}});
    module.run(20_ms);
  }
  Tmcm142Module module;
  module.device->connect_memory(memory);
  EXPECT_EQ(module.ggp(kAddress), 9);
  EXPECT_EQ(module.gap(bow), 5);
  EXPECT_EQ(module.device->tmcl().memory()[0], (tmcl::Instruction{.command = 1, .value = -70'000}));
  EXPECT_EQ(module.device->tmcl().memory()[1], tmcl::Instruction{.command = 28});
  EXPECT_EQ(module.device->tmcl().memory()[2], tmcl::Instruction{});
}

// The configured program is the one as delivered.
TEST(Tmcm142Memory, AnErasedProgramStaysErased) {
  Tmcm142Configuration delivered;
  delivered.program = {{.command = 1, .value = 5}, {.command = 28}};
  ModuleMemory memory;
  {
    Tmcm142Module module(delivered);
    module.device->connect_memory(memory);
    EXPECT_EQ(memory.orders, 0);
    ASSERT_EQ(module.sgp(kMagic, 0), Status::success);
    EXPECT_TRUE(memory.images.count(1) == 0) << "the program has not changed";
    module.power_cycle();
    module.run(20_ms);
  }
  Tmcm142Module module(delivered);
  module.device->connect_memory(memory);
  EXPECT_EQ(module.device->tmcl().memory()[0], tmcl::Instruction{});
}

TEST(Tmcm142Memory, ThatIsDamagedIsToldAndIgnored) {
  ModuleMemory memory;
  memory.images[0].resize(17);
  memory.images[1].resize(8);
  Tmcm142Module module;
  module.device->connect_memory(memory);
  EXPECT_EQ(module.events.count("do not fit this module"), 2);
  EXPECT_EQ(module.ggp(kAddress), 1);
}

}  // namespace
}  // namespace stator::tests
