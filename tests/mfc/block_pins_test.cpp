// The pins of the I/O block.

#include <gmock/gmock.h>

#include "mfc/block_fixture.hpp"
#include "stator/mfc/block/block.hpp"

namespace stator::mfc {
namespace {

using namespace base::literals;
using namespace register_number;
using testing::BlockFixture;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::LineChange;

constexpr std::size_t hv(std::size_t pin) {
  return kFirstHighVoltage + pin;
}

TEST(BlockPins, WithoutConfigurationAllFloat) {
  BlockFixture f;
  f.operational();
  for (std::size_t line = 0; line < kLines; ++line) {
    EXPECT_EQ(f.block.pin(line), PinState::floating);
  }
}

TEST(BlockPins, StaticLevelsAndTristateFollowTheirCodes) {
  BlockFixture f;
  f.connect(0, Signal::low).connect(1, Signal::high).connect(2, Signal::tri);
  f.configure();
  f.operational();
  EXPECT_EQ(f.block.pin(0), PinState::low);
  EXPECT_EQ(f.block.pin(1), PinState::high);
  EXPECT_EQ(f.block.pin(2), PinState::floating);
}

TEST(BlockPins, OutputsAreActiveInOperationalOnly) {
  BlockFixture f;
  f.connect(0, Signal::gpo0).connect(1, Signal::hs0).connect(2, Signal::s0).connect(3, Signal::cs0);
  f.connect(4, Signal::dac0).connect(5, Signal::high);
  f.configure();
  f.set(kGpo, 1);
  f.set(kGpioConfig, 1);
  for (const std::uint8_t state : std::initializer_list<std::uint8_t>{1, 2, 3, 4}) {
    f.block.set_al_state(state);
    for (std::size_t line = 0; line < 6; ++line) {
      EXPECT_EQ(f.block.pin(line), PinState::floating) << int{state} << " " << line;
    }
  }
  f.operational();
  for (std::size_t line = 0; line < 6; ++line) {
    EXPECT_NE(f.block.pin(line), PinState::floating) << line;
  }
  EXPECT_EQ(f.block.pin(0), PinState::high);
  f.block.set_al_state(4);
  EXPECT_EQ(f.block.pin(0), PinState::floating);
}

TEST(BlockPins, AlOverrideIsTheControllersAndNeedsNoState) {
  BlockFixture f;
  f.connect(0, Signal::gpo0).map(kGpo);
  f.configure();
  f.set(kGpioConfig, 1);
  EXPECT_EQ(f.block.pin(0), PinState::floating);
  f.set(kAlOverride, 0xFF);
  EXPECT_EQ(f.block.pin(0), PinState::low);
  EXPECT_EQ(f.get(kAlOverride), 0xFFU);
  f.master_writes(kGpo, 1);
  EXPECT_EQ(f.block.pin(0), PinState::low) << "the master still needs Operational";
  f.set(kAlOverride, 0);
  EXPECT_EQ(f.block.pin(0), PinState::floating);
}

TEST(BlockPins, GeneralPurposeOutputDrivesWhereItIsConfigured) {
  BlockFixture f;
  f.connect(7, Signal::gpo3).connect(hv(1), Signal::gpo3);
  f.configure();
  f.operational();
  f.set(kGpo, 0x0008);
  EXPECT_EQ(f.block.pin(7), PinState::floating);
  f.set(kGpioConfig, 0x0008);
  EXPECT_EQ(f.block.pin(7), PinState::high);
  EXPECT_EQ(f.block.voltage(7), 3300);
  EXPECT_EQ(f.block.voltage(hv(1)), 24'000) << "one signal on two lines";
}

TEST(BlockPins, InputsOfOneSignalAreCombinedByOr) {
  BlockFixture f;
  f.connect(3, Signal::gpi5).connect(9, Signal::gpi5);
  f.configure();
  f.block.drive(3, OutsideDrive::level(true), f.block.now());
  EXPECT_EQ(f.get(kGpi), 0x20U);
  f.block.drive(9, OutsideDrive::level(true), f.block.now());
  f.block.drive(3, OutsideDrive::level(false), f.block.now());
  EXPECT_EQ(f.get(kGpi), 0x20U);
  f.block.drive(9, OutsideDrive::level(false), f.block.now());
  EXPECT_EQ(f.get(kGpi), 0U);
}

TEST(BlockPins, EveryGeneralPurposeSignalFitsEveryPin) {
  for (std::size_t line = 0; line < kLines; ++line) {
    for (std::size_t i = 0; i < Gpio::kLines; ++i) {
      BlockFixture f;
      f.connect(line, offset(Signal::gpo0, i));
      f.configure();
      f.operational();
      f.set(kGpioConfig, 1U << i);
      EXPECT_EQ(f.block.pin(line), PinState::low);
      f.set(kGpo, 1U << i);
      EXPECT_EQ(f.block.pin(line), PinState::high);
      f.connect(line, offset(Signal::gpi0, i));
      f.configure();
      f.block.drive(line, OutsideDrive::level(true), f.block.now());
      EXPECT_EQ(f.get(kGpi), 1U << i);
    }
  }
}

TEST(BlockPins, EveryBridgeOutputFitsEveryPin) {
  for (std::size_t line = 0; line < kLines; ++line) {
    for (std::size_t channel = 0; channel < Pwm::kChannels; ++channel) {
      for (const std::size_t side : {0U, 1U}) {
        BlockFixture f;
        f.connect(line, offset(Signal::hs0, 2 * channel + side));
        f.configure();
        f.operational();
        EXPECT_EQ(f.block.pin(line), PinState::low);
        const std::uint64_t mode = side == 0 ? 2 : 1;  // one side permanently on
        f.set(kPwmCfg, 0x3E7 | mode << (16 + 4 * channel));
        EXPECT_EQ(f.block.pin(line), PinState::high) << line << " " << channel << " " << side;
      }
    }
  }
}

TEST(BlockPins, EncoderCountsWhatItsPinsSeeAndNotWhatAConnectionFinds) {
  BlockFixture f;
  f.block.drive(0, OutsideDrive::level(true), f.block.now());
  f.connect(0, Signal::a).connect(1, Signal::b);
  f.configure();
  EXPECT_EQ(f.get(kPositionRead), 0U);
  base::SimTime time;
  const auto edge = [&](std::size_t line, bool level) {
    time += 1_us;
    f.block.drive(line, OutsideDrive::level(level), time);
  };
  edge(1, true);
  edge(0, false);
  edge(1, false);
  edge(0, true);
  const auto position = static_cast<std::int32_t>(f.get(kPositionRead));
  EXPECT_EQ(std::abs(position), 4);
  edge(0, false);
  edge(1, true);
  EXPECT_EQ(static_cast<std::int32_t>(f.get(kPositionRead)), position / 2);
}

// 1/16 of a count per edge: a fraction lost at each write would be most of the way.
TEST(BlockPins, EncoderKeepsItsFractionWhateverIsWrittenToTheParameters) {
  for (const bool decimal : {false, true}) {
    BlockFixture f;
    f.connect(0, Signal::a).connect(1, Signal::b);
    f.configure();
    f.set(kEncMode, decimal ? 1U << 10U : 0U);
    f.set(kEncConst, decimal ? 625U : 65'536U / 16);
    constexpr std::array<std::pair<std::size_t, bool>, 4> kEdges{
        {{0, true}, {1, true}, {0, false}, {1, false}}};
    base::SimTime time;
    for (int edge = 0; edge < 1600; ++edge) {
      time += 1_us;
      const auto& [line, level] = kEdges[static_cast<std::size_t>(edge) % 4];
      f.block.drive(line, OutsideDrive::level(level), time);
      if (edge % 7 == 0) {
        f.connect(9, edge % 2 == 0 ? Signal::high : Signal::low);
        f.configure();
      } else if (edge % 11 == 0) {
        f.set(kHvioCfg, static_cast<std::uint64_t>(edge % 2));
      }
    }
    EXPECT_EQ(f.get(kPositionRead), 100U) << (decimal ? "decimal" : "binary");
  }
}

TEST(BlockPins, MappingNToAHighPinIsNoNEvent) {
  BlockFixture f;
  f.connect(0, Signal::a).connect(1, Signal::b);
  f.configure();
  f.block.drive(2, OutsideDrive::level(true), f.block.now());
  f.set(kPositionWrite, 50);
  f.set(kEncMode, 0x16C);  // clear and latch once, when N becomes high, whatever A and B are
  f.connect(2, Signal::n);
  f.configure();
  EXPECT_EQ(f.get(kPositionRead), 50U);
  EXPECT_EQ(f.get(kEncStatus), 0U);
  EXPECT_EQ(f.get(kMfcioIrqFlags), 0U);
  f.block.drive(2, OutsideDrive::level(false), f.block.now());
  f.block.drive(2, OutsideDrive::level(true), f.block.now());
  EXPECT_EQ(f.get(kEncLatch), 50U) << "the latch was still waiting";
  EXPECT_EQ(f.get(kPositionRead), 0U);
  EXPECT_EQ(f.get(kEncStatus), 1U);
}

TEST(BlockPins, DifferentialPairFeedsTheCrossbarOfItsFirstInput) {
  BlockFixture f;
  f.connect(hv(0), Signal::gpi0).connect(hv(3), Signal::gpi1);
  f.configuration.set_high_voltage(0x0100'0000);
  f.configure();
  f.block.drive(hv(0), OutsideDrive::voltage(2000), f.block.now());
  f.block.drive(hv(3), OutsideDrive::voltage(3000), f.block.now());
  EXPECT_EQ(f.get(kGpi), 0x1U);
  f.block.drive(hv(3), OutsideDrive::voltage(1000), f.block.now());
  EXPECT_EQ(f.get(kGpi), 0x0U);
  f.set(kHvioCfg, 0);
  f.block.drive(hv(3), OutsideDrive::voltage(24'000), f.block.now());
  EXPECT_EQ(f.get(kGpi), 0x2U) << "single inputs again";
}

TEST(BlockPins, ConfigurationMayChangeAtAnyTime) {
  BlockFixture f;
  f.connect(0, Signal::high);
  f.configure();
  f.operational();
  f.block.watch(kAllLines);
  f.wait(1_us);
  f.connect(0, Signal::low).connect(1, Signal::high);
  f.configure();
  EXPECT_THAT(f.changes,
              ElementsAre(LineChange{1000, 0, PinState::low}, LineChange{1000, 1, PinState::high}));
}

TEST(BlockPins, WatchedEdgesComeInOrderOfTimeAndUnwatchedOnesCostNothing) {
  BlockFixture f;
  f.connect(0, Signal::hs0).connect(1, Signal::s0);
  f.configure();
  f.operational();
  f.set(kPwmCfg, 0x0000'0000'0006'03E7);  // 10 us, HS of channel 0
  f.set(kSdCfg, 0x03);
  f.set(kSdCh0Steprate, 171'799'000);  // about 1 MHz
  EXPECT_EQ(f.block.next_event(), base::SimTime::never());
  f.set(kPwm1, 500);
  f.block.watch(line_bit(1));
  f.wait(100_us);
  EXPECT_GT(f.changes.size(), 190U);
  for (std::size_t i = 1; i < f.changes.size(); ++i) {
    EXPECT_LE(f.changes[i - 1].time, f.changes[i].time);
    EXPECT_EQ(f.changes[i].line, 1U);
  }
  f.block.watch(0);
  f.changes.clear();
  EXPECT_EQ(f.block.next_event(), base::SimTime::never());
  f.wait(1_s);
  EXPECT_THAT(f.changes, IsEmpty());
  EXPECT_NEAR(static_cast<double>(f.get(kSdCh0Stepcount)), 1'000'100.0, 200.0);
}

}  // namespace
}  // namespace stator::mfc
