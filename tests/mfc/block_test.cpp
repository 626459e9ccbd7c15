// Registers of the I/O block from both sides, and what faults, safe states and interrupts do to its
// pins.
#include "stator/mfc/block/block.hpp"

#include <gmock/gmock.h>

#include "mfc/block_fixture.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using namespace register_number;
using testing::BlockFixture;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::kInterruptLine;
using testing::LineChange;

constexpr std::size_t hv(std::size_t pin) {
  return kFirstHighVoltage + pin;
}

TEST(BlockSides, MappedRegistersAreWrittenByTheMasterOnlyAndReadByBoth) {
  BlockFixture f;
  f.map(kDacVal);
  f.configure();
  f.operational();
  f.set(kDacVal, 0x1234);
  EXPECT_EQ(f.get(kDacVal), 0U);
  f.master_writes(kDacVal, 0x5678);
  EXPECT_EQ(f.get(kDacVal), 0x5678U);
  f.set(kPwm1, 0x0123);
  EXPECT_EQ(f.get(kPwm1), 0x0123U) << "not mapped: the controller's";
}

TEST(BlockSides, EveryWriteRegisterReadsBackWhatWasWritten) {
  base::Random random(66);
  BlockFixture f;
  f.configure();
  for (const Register& entry : kRegisters) {
    if (entry.direction != Direction::write || entry.number == kI2cControl ||
        entry.number == kWdCfg || entry.number == kEncMode || entry.number == kSpiTxData ||
        entry.number == kMfcioIrqCfg || entry.number == kWdTime) {
      continue;
    }
    const std::uint64_t mask =
        entry.size == 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << entry.width_bits()) - 1;
    const std::uint64_t value = random.next() & mask;
    f.set(entry.number, value);
    EXPECT_EQ(f.get(entry.number), value) << entry.name;
  }
}

TEST(BlockSides, ReadRegistersIgnoreWritesAndMissingOnesReadZero) {
  BlockFixture f;
  f.configure();
  f.set(kEncMode, 0x0004);  // N active high: no event goes on
  for (const Register& entry : kRegisters) {
    if (entry.direction == Direction::write) {
      continue;
    }
    const std::uint64_t before = f.get(entry.number);
    f.set(entry.number, 0xA5A5A5A5A5A5A5A5, 8);
    EXPECT_EQ(f.get(entry.number), before) << entry.name;
  }
  std::array<std::byte, 4> beyond{};
  beyond.fill(std::byte{0xFF});
  f.block.read(0x0430, beyond);
  EXPECT_EQ(base::load_le<std::uint32_t>(beyond), 0U);
}

TEST(BlockSides, BytesBeyondARegisterAreIgnoredAndReadZero) {
  BlockFixture f;
  f.configure();
  f.set(kSpiLength, 0xFFFF'FF13, 4);
  EXPECT_EQ(f.get(kSpiLength), 0x13U);
  EXPECT_EQ(f.get(kSpiTime), 0U);
}

TEST(BlockSides, PartOfARegisterCanBeWritten) {
  BlockFixture f;
  f.configure();
  f.set(kGpo, 0x4433'2211);
  const std::array<std::byte, 2> part{std::byte{0xAA}, std::byte{0xBB}};
  f.block.write(kGpo << 4 | 1, part);
  EXPECT_EQ(f.get(kGpo), 0x44BB'AA11U);
}

TEST(BlockSides, ResetValuesAreThoseOfTheTables) {
  BlockFixture f;
  f.configure();
  f.set(kEncConst, 7);
  f.block.reset();
  for (const Register& entry : kRegisters) {
    const std::uint64_t expected = entry.number == kSpiStatus ? 1 : reset_value(entry.number);
    EXPECT_EQ(f.get(entry.number), expected) << entry.name;
  }
}

TEST(BlockSides, SyncEventCountersAreTheMastersAlone) {
  BlockFixture f;
  f.map(kSyncEventCount);
  f.configure();
  f.operational();
  for (int i = 0; i < 70'000; ++i) {
    f.block.trigger(Trigger::sync0);
  }
  f.block.trigger(Trigger::sync1);
  EXPECT_EQ(f.master_reads(kSyncEventCount), 0x0001'0000U + (70'000U - 65'536U));
  EXPECT_EQ(f.master_reads(kSyncEventCount), 0x0001'0000U + (70'000U - 65'536U)) << "no clearing";
  EXPECT_EQ(f.get(kSyncEventCount), 0U);
}

TEST(BlockFaults, AnalogStatusShowsWhatTestsInject) {
  BlockFixture f;
  f.configure();
  EXPECT_EQ(f.get(kHvAnaStatus), 0U);
  f.block.set_high_voltage_overheated(true);
  f.block.set_fixed_regulator_short(true);
  f.block.set_adjustable_regulator_short(true);
  f.block.set_adjustable_regulator_overheated(true);
  EXPECT_EQ(f.get(kHvAnaStatus), 0x0F00'0000U);
  EXPECT_EQ(f.get(kMfcioIrqFlags), 0x000F'0000U);
  EXPECT_EQ(f.get(kMfcioIrqFlags), 0U) << "events, not levels";
  f.block.set_high_voltage_overheated(false);
  f.set(kBuckConvCfg, 0x4040);
  EXPECT_EQ(f.get(kHvAnaStatus), 0x0800'0000U) << "no protection, no flag";
}

TEST(BlockFaults, OverheatedHighVoltageBlockLetsItsPinsGo) {
  BlockFixture f;
  f.connect(0, Signal::high).connect(hv(0), Signal::high);
  f.configure();
  f.operational();
  f.block.watch(kAllLines);
  f.block.set_high_voltage_overheated(true);
  EXPECT_THAT(f.changes, ElementsAre(LineChange{0, hv(0), PinState::floating}));
}

TEST(BlockFaults, ShortedOutputIsOffUntilItToggles) {
  BlockFixture f;
  f.connect(hv(2), Signal::gpo0);
  f.configure();
  f.operational();
  f.set(kGpioConfig, 1);
  f.set(kGpo, 1);
  f.block.set_short(hv(2), Short::to_ground);
  f.wait(1_ms);
  EXPECT_EQ(f.get(kHvAnaStatus), 0x0000'0400U);
  EXPECT_EQ(f.get(kMfcioIrqFlags), 0U) << "no interrupt of its own (A-62)";
  f.block.set_short(hv(2), Short::none);
  EXPECT_EQ(f.get(kHvAnaStatus), 0x0000'0400U);
  f.set(kGpo, 0);
  f.set(kGpo, 1);
  EXPECT_EQ(f.get(kHvAnaStatus), 0x0000'0004U);
}

TEST(BlockFaults, AnalogSettingsComeFromTheParametersAndTheController) {
  BlockFixture f;
  f.configuration.set_high_voltage(0x0000'0101);
  f.configuration.set_regulators(0x8001);
  f.configure();
  EXPECT_EQ(f.get(kHvioCfg), 0x0000'0101U);
  EXPECT_EQ(f.get(kBuckConvCfg), 0x8001U);
  EXPECT_FALSE(f.block.regulators().adjustable().enabled);
  f.set(kHvioCfg, 0x0000'0202);
  f.connect(0, Signal::high);
  f.configure();
  EXPECT_EQ(f.get(kHvioCfg), 0x0000'0202U) << "other parameters leave it alone";
  f.configuration.set_high_voltage(0x0000'0303);
  f.configure();
  EXPECT_EQ(f.get(kHvioCfg), 0x0000'0303U);
}

TEST(BlockSafety, WatchdogTakesPinsWhateverTheirFunctionAndState) {
  BlockFixture f;
  f.connect(0, Signal::high);
  f.configure();
  f.block.watch(line_bit(0) | line_bit(1) | line_bit(2));
  f.set(kWdOutMaskPol, 0x0000'0007'0000'0002);
  f.set(kWdOePol, 0x3);
  f.set(kWdCfg, 0x08);   // start of frame
  f.set(kWdTime, 2500);  // 100 us
  f.wait(50_us);
  f.block.trigger(Trigger::start_of_frame);
  f.wait(99_us);
  EXPECT_THAT(f.changes, IsEmpty());
  f.wait(2_us);
  EXPECT_THAT(f.changes, ElementsAre(LineChange{150'000, 0, PinState::low},
                                     LineChange{150'000, 1, PinState::high}));
  EXPECT_EQ(f.get(kWdCfg), 0x88U);
  f.changes.clear();
  f.block.trigger(Trigger::start_of_frame);
  EXPECT_THAT(f.changes, ElementsAre(LineChange{151'000, 0, PinState::floating},
                                     LineChange{151'000, 1, PinState::floating}));
}

TEST(BlockSafety, WatchdogSeesTheLevelsOfPinsThatTheChipDrives) {
  BlockFixture f;
  f.connect(4, Signal::gpo0);
  f.configure();
  f.operational();
  f.set(kGpioConfig, 1);
  f.set(kWdInMaskPol, 0x0000'0010'0000'0010);
  f.set(kWdCfg, 0x10);
  f.set(kWdTime, 2500);
  f.wait(60_us);
  f.set(kGpo, 1);  // becomes true: triggers
  f.wait(60_us);
  EXPECT_FALSE(f.block.watchdog_action().active);
  f.set(kGpo, 0);
  f.wait(60_us);
  EXPECT_TRUE(f.block.watchdog_action().active);
}

TEST(BlockSafety, EmergencyPutsOutputsIntoTheirSafeState) {
  BlockFixture f;
  f.connect(0, Signal::gpo0).connect(1, Signal::gpo1).connect(2, Signal::hs0);
  f.configure();
  f.operational();
  f.block.set_emergency_pin(true);
  f.set(kMfcioIrqCfg, 0x80'0000);
  f.set(kGpioConfig, 3);
  f.set(kGpo, 0x0002'0001);
  f.set(kPwmCfg, 0x0000'0000'0006'03E7);
  f.set(kPwm1, 4095);
  f.block.watch(7);
  EXPECT_EQ(f.block.pin(2), PinState::high);
  f.wait(1_us);
  f.changes.clear();
  f.block.set_emergency_pin(false);
  EXPECT_THAT(f.changes,
              ::testing::UnorderedElementsAre(LineChange{1000, 0, PinState::low},
                                              LineChange{1000, 1, PinState::high},
                                              LineChange{1000, 2, PinState::low},
                                              LineChange{1000, kInterruptLine, PinState::high}));
  f.block.set_emergency_pin(true);
  EXPECT_EQ(f.block.pin(0), PinState::low) << "the flag holds it";
  f.set(kMfcioIrqCfg, 0);
  f.set(kMfcioIrqCfg, 0x80'0000);
  EXPECT_EQ(f.block.pin(0), PinState::high);
}

TEST(BlockInterrupt, PinFollowsFlagsAndMaskInTime) {
  BlockFixture f;
  f.configure();
  f.set(kSdCfg, 0x01);
  f.set(kSdCh0Steprate, 0x4000'0000);
  f.set(kMfcioIrqCfg, 0x02);
  f.set(kSdCh0Steptarget, 10);
  f.wait(1_ms);
  ASSERT_EQ(f.changes.size(), 1U);
  EXPECT_EQ(f.changes[0].line, kInterruptLine);
  EXPECT_GT(f.changes[0].time, 1500);
  EXPECT_LT(f.changes[0].time, 2500);
  EXPECT_TRUE(f.block.interrupt_pin());
  EXPECT_EQ(f.get(kMfcioIrqFlags), 0x02U);
  EXPECT_FALSE(f.block.interrupt_pin());
}

}  // namespace
}  // namespace stator::mfc
