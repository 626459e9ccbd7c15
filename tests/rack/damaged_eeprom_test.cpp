// Products whose EEPROM is damaged: dead to their firmware until a master repairs it.

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/fault_bench.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using ethercat::Command;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr rack::DeviceAddress kDevice{0, 0, rack::NetworkKind::segment};

class DamagedEeprom : public ::testing::TestWithParam<const char*> {
 protected:
  DamagedEeprom()
      : bench("[[segment]]\n[[segment.device]]\ntype = \"" + std::string(GetParam()) +
              "\"\nname = \"device\"\n") {}

  void cycle_power() {
    bench.rack.apply(rack::PowerEvent{kDevice, false}, bench.now());
    bench.rack.apply(rack::PowerEvent{kDevice, true}, bench.now());
  }
  void write(std::uint16_t address, std::uint16_t value) {
    static_cast<void>(bench.send(Command::apwr, 0, address, value));
  }
  /// Data and address first, then the command with write enable.
  void write_word(std::uint16_t word, std::uint16_t value) {
    write(0x0504, word);
    write(0x0508, value);
    write(0x0502, 0x0201);
    bench.port.wait(2_ms);
  }
  void reload() {
    write(0x0502, 0x0400);
    bench.port.wait(5_ms);
  }
  /// Asks for Pre-Operational with mailboxes where the scan has found them; a scan asks for Init.
  bool reaches_pre_operational() {
    return bench.scan() == 1 && bench.master.start_mailbox(0).has_value();
  }
  void expect_dead() {
    EXPECT_FALSE(reaches_pre_operational());
    EXPECT_EQ(bench.read(0, 0x0130), 0x0001U) << "AL status";
    EXPECT_EQ(bench.read(0, 0x0134), 0x0000U) << "nobody gives a reason";
    static_cast<void>(bench.send(Command::apwr, 0, 0x0120, 0x0002));
    bench.port.wait(100_ms);
    EXPECT_EQ(bench.read(0, 0x0130), 0x0001U);
  }

  SegmentFaultBench bench;
};

TEST_P(DamagedEeprom, LeavesTheDeviceInInitUntilTheMasterWritesAGoodOneAndReloadsIt) {
  const std::uint16_t good =
      std::to_integer<std::uint16_t>(bench.rack.segment(0).slave(0).sii()[14]);
  ASSERT_TRUE(reaches_pre_operational());
  write(0x0500, 0);  // the master takes the EEPROM back from the firmware
  write_word(7, static_cast<std::uint16_t>(good ^ 0xFFU));
  EXPECT_EQ(bench.read(0, 0x0130), 0x0002U) << "counts from the next load on";
  cycle_power();
  expect_dead();
  EXPECT_EQ(bench.read(0, 0x0110) & 1U, 0U);
  EXPECT_EQ(bench.log.count("esc-sii-checksum"), 1U) << "one line at the start";
  EXPECT_GE(bench.log.count("esc-al-control-host-closed"), 1U) << "and one for each request";
  EXPECT_EQ(bench.log.count("esc-al-control-locked"), 0U) << "not two";
  write_word(7, good);
  expect_dead();
  reload();
  EXPECT_EQ(bench.read(0, 0x0110) & 1U, 1U);
  EXPECT_TRUE(reaches_pre_operational());
  EXPECT_TRUE(bench.master.upload(0, {0x1000, 0}));
}

TEST_P(DamagedEeprom, WithAnotherHostInterfaceIsDeadUntilAResetOfTheController) {
  const auto sii = bench.rack.segment(0).slave(0).sii();
  const auto word0 = base::load_le<std::uint16_t>(sii, 0);
  const auto good = std::to_integer<std::uint16_t>(sii[14]);
  write_word(0, static_cast<std::uint16_t>((word0 & 0xFF00U) | 0x08U));
  write_word(7, ethercat::sii_checksum(bench.rack.segment(0).slave(0).sii()));
  cycle_power();
  expect_dead();
  EXPECT_EQ(bench.read(0, 0x0140) & 0xFFU, 0x08U);
  EXPECT_EQ(bench.read(0, 0x014E) & 0x0FU, 0x0AU) << "configured, but invalid";
  EXPECT_EQ(bench.log.count("esc-pdi-type"), 1U);
  write_word(0, word0);
  write_word(7, good);
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    write(0x0040, static_cast<std::uint16_t>(key));
  }
  EXPECT_TRUE(reaches_pre_operational());
}

TEST_P(DamagedEeprom, FaultOfACellClosesItAtTheNextPowerOn) {
  ASSERT_TRUE(reaches_pre_operational());
  const auto fault = bench.inject("kind = 'sii-corruption'\ndevice = 'device'");
  EXPECT_EQ(bench.read(0, 0x0130), 0x0002U) << "counts from the next load on";
  cycle_power();
  expect_dead();
  bench.clear(fault);
  reload();
  EXPECT_TRUE(reaches_pre_operational());
}

INSTANTIATE_TEST_SUITE_P(Products, DamagedEeprom, ::testing::Values("tmcm-3315", "tmc8670"),
                         [](const auto& test) {
                           std::string name(test.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(DamagedEepromOfADrive, EndsItsMotionWhenItIsReloadedInOperational) {
  SegmentFaultBench bench("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n");
  bench.bring_to_operational(1);
  const auto fault = bench.inject("kind = 'sii-corruption'\ndevice = 'tmcm-3315'");
  static_cast<void>(bench.send(Command::apwr, 0, 0x0502, 0x0400));
  bench.port.wait(5_ms);
  EXPECT_EQ(bench.log.count("al-controller-lost"), 1U);
  EXPECT_EQ(bench.read(0, 0x0130), 0x0008U) << "nobody can write AL status";
  bench.clear(fault);
  static_cast<void>(bench.send(Command::apwr, 0, 0x0502, 0x0400));
  bench.port.wait(5_ms);
  EXPECT_EQ(bench.read(0, 0x0130), 0x0001U);
  bench.bring_to_operational(1);
}

TEST(DamagedEepromOfAChip, WithDeviceEmulationByItsPinTheStateStillFollowsTheMaster) {
  SegmentFaultBench bench(
      "[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\ndevice_emulation = true\n");
  bench.inject("kind = 'sii-corruption'\ndevice = 'tmc8461'");
  bench.rack.apply(rack::PowerEvent{kDevice, false}, bench.now());
  bench.rack.apply(rack::PowerEvent{kDevice, true}, bench.now());
  static_cast<void>(bench.send(Command::apwr, 0, 0x0120, 0x0002));
  EXPECT_EQ(bench.read(0, 0x0130), 0x0002U);
}

TEST(ChipWithoutFirmware, SaysSoWhenAMasterRequestsAState) {
  SegmentFaultBench bench("[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\n");
  static_cast<void>(bench.send(Command::apwr, 0, 0x0120, 0x0002));
  ASSERT_EQ(bench.log.events().size(), 1U);
  EXPECT_THAT(bench.log.line(bench.log.events().back()),
              AllOf(HasSubstr("tmc8461: AL control 0002h stays unanswered"),
                    HasSubstr("\"device_emulation = true\"")));
}

}  // namespace
}  // namespace stator::tests
