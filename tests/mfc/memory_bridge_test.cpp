// When registers of the I/O block and process data memory are exchanged, by trigger and state.
#include "stator/mfc/block/memory_bridge.hpp"

#include <gmock/gmock.h>

#include "mfc/block_fixture.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using namespace register_number;
using testing::BlockFixture;

TEST(MemoryBridge, TransparentRegistersFollowTheMasterAtOnce) {
  for (const Trigger trigger : {Trigger::always, Trigger::always_too}) {
    BlockFixture f;
    f.map(kDacVal, trigger).map(kGpi, trigger).connect(0, Signal::gpi4);
    f.configure();
    f.operational();
    f.master_writes(kDacVal, 0xABCD);
    EXPECT_EQ(f.get(kDacVal), 0xABCDU);
    f.block.drive(0, OutsideDrive::level(true), f.block.now());
    EXPECT_EQ(f.master_reads(kGpi), 0x10U);
  }
}

TEST(MemoryBridge, EachTriggerExchangesItsRegistersOnly) {
  for (unsigned code = 1; code <= 10; ++code) {
    const auto trigger = static_cast<Trigger>(code);
    BlockFixture f;
    f.map(kDacVal, trigger).map(kGpi, trigger).connect(0, Signal::gpi0);
    f.configure();
    f.operational();
    f.master_writes(kDacVal, 0x1111);
    f.block.drive(0, OutsideDrive::level(true), f.block.now());
    for (unsigned other = 1; other <= 10; ++other) {
      if (other != code) {
        f.block.trigger(static_cast<Trigger>(other));
      }
    }
    EXPECT_EQ(f.get(kDacVal), 0U) << code;
    EXPECT_EQ(f.master_reads(kGpi), 0U) << code;
    f.block.trigger(trigger);
    EXPECT_EQ(f.get(kDacVal), 0x1111U) << code;
    EXPECT_EQ(f.master_reads(kGpi), 1U) << code;
  }
}

TEST(MemoryBridge, BeforeTransfersTheFormerValueAndAfterTheNewOne) {
  BlockFixture f;
  f.map(kDacVal, Trigger::before_bridge).map(kPwm1, Trigger::after_bridge);
  f.map(kGpi, Trigger::after_bridge).map(kWdMax, Trigger::before_bridge).connect(0, Signal::gpi0);
  f.configure();
  f.operational();
  f.master_writes(kDacVal, 1);
  EXPECT_EQ(f.get(kDacVal), 0U);
  f.master_writes(kDacVal, 2);
  EXPECT_EQ(f.get(kDacVal), 1U);
  f.master_writes(kPwm1, 7);
  EXPECT_EQ(f.get(kPwm1), 7U);
  f.block.drive(0, OutsideDrive::level(true), f.block.now());
  EXPECT_EQ(f.master_reads(kGpi), 0U) << "shadow as after the former read";
  EXPECT_EQ(f.master_reads(kGpi), 1U);
}

TEST(MemoryBridge, PwmZeroTransfersAtTheCountersZero) {
  BlockFixture f;
  f.map(kPwm1, Trigger::pwm_zero);
  f.configure();
  f.operational();
  f.set(kPwmCfg, 0x0000'0000'0006'03E7);
  f.wait(12_us);
  f.master_writes(kPwm1, 300);
  f.wait(7990_ns);
  EXPECT_EQ(f.get(kPwm1), 0U);
  f.wait(10_ns);
  EXPECT_EQ(f.get(kPwm1), 300U);
}

TEST(MemoryBridge, NeverTransfersNothing) {
  BlockFixture f;
  f.map(kDacVal, Trigger::never).map(kGpi, Trigger::never).connect(0, Signal::gpi0);
  f.configure();
  f.operational();
  f.block.drive(0, OutsideDrive::level(true), f.block.now());
  f.master_writes(kDacVal, 1);
  for (unsigned code = 1; code <= 10; ++code) {
    f.block.trigger(static_cast<Trigger>(code));
  }
  EXPECT_EQ(f.get(kDacVal), 0U);
  EXPECT_EQ(f.master_reads(kGpi), 0U);
}

TEST(MemoryBridge, MasterReadsFromSafeOperationalAndWritesInOperational) {
  for (const std::uint8_t state : std::initializer_list<std::uint8_t>{1, 2, 3, 4, 8}) {
    BlockFixture f;
    f.map(kDacVal).map(kGpi).connect(0, Signal::gpi0);
    f.configure();
    f.block.set_al_state(state);
    f.block.drive(0, OutsideDrive::level(true), f.block.now());
    f.master_writes(kDacVal, 5);
    EXPECT_EQ(f.get(kDacVal), state == 8 ? 5U : 0U) << int{state};
    EXPECT_EQ(f.master_reads(kGpi), state >= 4 ? 1U : 0U) << int{state};
    EXPECT_EQ(f.get(kGpi), 1U) << "the controller reads in every state";
  }
}

TEST(MemoryBridge, ActionsHappenOncePerWriteOfTheMaster) {
  BlockFixture f;
  f.map(kPositionWrite).map(kGpo).connect(0, Signal::a).connect(1, Signal::b);
  f.configure();
  f.operational();
  f.master_writes(kPositionWrite, 100);
  EXPECT_EQ(f.get(kPositionRead), 100U);
  f.block.drive(0, OutsideDrive::level(true), f.block.now());
  const std::uint64_t moved = f.get(kPositionRead);
  EXPECT_NE(moved, 100U);
  f.master_writes(kGpo, 3);
  EXPECT_EQ(f.get(kPositionRead), moved) << "no pass of the bridge repeats it";
  f.master_writes(kPositionWrite, 100);
  EXPECT_EQ(f.get(kPositionRead), 100U);
}

TEST(MemoryBridge, AnEqualStepRateIsNoNewOne) {
  BlockFixture f;
  f.map(kSdCh0Steprate);
  f.configure();
  f.operational();
  f.set(kSdCfg, 0x03);
  for (int cycle = 0; cycle < 100; ++cycle) {
    f.master_writes(kSdCh0Steprate, 171'799);  // 1 kHz, every 100 us
    f.wait(100_us);
  }
  EXPECT_NEAR(static_cast<double>(f.get(kSdCh0Stepcount)), 10.0, 1.0);
}

// The shadow of a mapped register is transparent (L8875-L8877): a master that writes STEPRATE has
// it, also after NEXTSR has come into it (G-35). With SYNC0 it is the pulse that brings it.
TEST(MemoryBridge, ARateThatNextsrReplacedIsTheMastersAgainWithItsNextWrite) {
  constexpr std::uint64_t kSlow = 171'799;  // 1 kHz
  constexpr std::uint64_t kFast = 10 * kSlow;
  for (const Trigger trigger : {Trigger::always, Trigger::sync0}) {
    BlockFixture f;
    f.map(kSdCh0Steprate, trigger);
    f.configure();
    f.operational();
    const auto cycle = [&] {
      f.master_writes(kSdCh0Steprate, kSlow);
      f.block.trigger(Trigger::sync0);
    };
    f.set(kSdCh0Compare, 3);
    f.set(kSdCh0Nextsr, kFast);
    f.set(kSdCfg, 0x43);
    cycle();
    f.wait(3500_us);
    EXPECT_EQ(f.get(kSdCh0Steprate), kFast);
    cycle();
    EXPECT_EQ(f.get(kSdCh0Steprate), kSlow);
    const std::uint64_t count = f.get(kSdCh0Stepcount);
    for (int n = 0; n < 100; ++n) {
      f.wait(100_us);
      cycle();
    }
    EXPECT_NEAR(static_cast<double>(f.get(kSdCh0Stepcount) - count), 10.0, 1.0)
        << "the same rate again changes nothing";
  }
}

TEST(MemoryBridge, PartOfARateIsWrittenIntoWhatNextsrBrought) {
  BlockFixture f;
  f.set(kSdCh0Compare, 1);
  f.set(kSdCh0Nextsr, 0x0102'0304);
  f.set(kSdCfg, 0x43);
  f.set(kSdCh0Steprate, 1'717'990);
  f.wait(1100_us);
  ASSERT_EQ(f.get(kSdCh0Steprate), 0x0102'0304U);
  f.set(kSdCh0Steprate, 0x55, 1);
  EXPECT_EQ(f.get(kSdCh0Steprate), 0x0102'0355U);
}

TEST(MemoryBridge, StepsGoOnUntilTheTriggerBringsTheNewRate) {
  BlockFixture f;
  f.map(kSdCh0Steprate, Trigger::sync0);
  f.configure();
  f.operational();
  f.set(kSdCfg, 0x03);
  f.master_writes(kSdCh0Steprate, 171'799);
  f.block.trigger(Trigger::sync0);
  f.wait(10500_us);
  EXPECT_EQ(f.get(kSdCh0Stepcount), 10U);
  f.master_writes(kSdCh0Steprate, 0);
  f.wait(10_ms);
  EXPECT_EQ(f.get(kSdCh0Stepcount), 20U);
  f.block.trigger(Trigger::sync0);
  f.wait(10_ms);
  EXPECT_EQ(f.get(kSdCh0Stepcount), 20U);
}

TEST(MemoryBridge, SpiTransferNeedsTheHighestUsedByte) {
  BlockFixture f;
  f.map(kSpiTxData);
  f.configure();
  f.operational();
  f.set(kSpiLength, 0x0F);
  const std::uint16_t at = f.address(kSpiTxData);
  const std::array<std::byte, 2> data{std::byte{0x34}, std::byte{0x12}};
  f.ram.write(at, data);
  f.block.after_bus_write(at, 1);
  EXPECT_EQ(f.get(kSpiStatus), 1U);
  f.block.after_bus_write(static_cast<std::uint16_t>(at + 1), 1);
  EXPECT_EQ(f.get(kSpiStatus), 0U);
  f.wait(1_ms);
  EXPECT_EQ(f.get(kSpiStatus), 1U);
}

TEST(MemoryBridge, FlagsClearOnTheirWayToTheMaster) {
  BlockFixture f;
  f.map(kMfcioIrqFlags);
  f.configure();
  f.operational();
  f.block.set_high_voltage_overheated(true);
  EXPECT_EQ(f.master_reads(kMfcioIrqFlags), 0x1'0000U);
  EXPECT_EQ(f.master_reads(kMfcioIrqFlags), 0U);
}

TEST(MemoryBridge, FlagsMayWaitForTheMastersRead) {
  BlockFixture f;
  f.map(kMfcioIrqFlags, Trigger::sync0);
  f.configure();
  f.operational();
  f.block.set_high_voltage_overheated(true);
  f.block.trigger(Trigger::sync0);
  f.block.trigger(Trigger::sync0);
  EXPECT_EQ(f.master_reads(kMfcioIrqFlags), 0U) << "the first transfer took them";
  f.block.set_flag_clearing(MemoryBridge::FlagClearing::by_master);
  f.block.set_high_voltage_overheated(false);
  f.block.set_high_voltage_overheated(true);
  f.block.trigger(Trigger::sync0);
  f.block.trigger(Trigger::sync0);
  EXPECT_EQ(f.master_reads(kMfcioIrqFlags), 0x1'0000U);
  f.block.trigger(Trigger::sync0);
  EXPECT_EQ(f.master_reads(kMfcioIrqFlags), 0U);
}

TEST(MemoryBridge, PaddingIsPlainMemory) {
  BlockFixture f;
  f.map(kEncStatus).map(kPositionRead);
  f.configure();
  f.operational();
  std::array<std::byte, 3> padding{std::byte{1}, std::byte{2}, std::byte{3}};
  f.ram.write(BlockFixture::kReads + 1, padding);
  f.block.before_bus_read(BlockFixture::kReads, 8);
  std::array<std::byte, 3> seen{};
  f.ram.read(BlockFixture::kReads + 1, seen);
  EXPECT_EQ(seen, padding);
  EXPECT_EQ(f.ram.finished, 1) << "one access for the block";
}

TEST(MemoryBridge, BlocksOutsideTheMemoryAreNotTransferred) {
  BlockFixture f;
  f.map(kDacVal).map(kGpi).connect(0, Signal::gpi0);
  f.configuration.set_block_start(0, 0x0FFE);
  f.configuration.set_block_start(1, 0x4FFE);
  f.configure();
  f.operational();
  f.block.drive(0, OutsideDrive::level(true), f.block.now());
  f.master_writes(kDacVal, 1);
  EXPECT_EQ(f.get(kDacVal), 0U);
  EXPECT_EQ(f.master_reads(kGpi), 0U);
}

TEST(MemoryBridge, OfRandomConfigurationsMovesEveryRegisterToItsPlace) {
  base::Random random(88);
  for (int run = 0; run < 200; ++run) {
    BlockFixture f;
    for (const Register& entry : kRegisters) {
      if (entry.mappable() && random.below(2) == 0) {
        f.map(entry.number);
      }
    }
    f.configure();
    f.operational();
    for (const std::uint8_t number : {kEncConst, kSpiLength, kSdCh1Compare, kSdSteplength, kPwm3,
                                      kPwmPulseBPulseA, kGpo, kDacVal, kWdOePol}) {
      const std::uint64_t value =
          random.next() & ((std::uint64_t{1} << kRegisters[number].width_bits()) - 1);
      if (f.block.memory_map().mapped(number)) {
        f.master_writes(number, value);
        EXPECT_EQ(f.get(number), value) << kRegisters[number].name;
      } else {
        f.set(number, value);
        EXPECT_EQ(f.get(number), value) << kRegisters[number].name;
      }
    }
  }
}

}  // namespace
}  // namespace stator::mfc
