// Levels at the pads of the I/O block: drivers, supplies, thresholds, filters, shorts.
#include "stator/mfc/pins/pads.hpp"

#include <gmock/gmock.h>

namespace stator::mfc {
namespace {

using namespace base::literals;

constexpr std::size_t hv(std::size_t pin) {
  return kFirstHighVoltage + pin;
}
constexpr base::SimTime at(base::SimDuration time) {
  return base::SimTime(time);
}
constexpr PinCommand kHigh{true, true};
constexpr PinCommand kLow{true, false};
constexpr PinCommand kOff{false, false};

bool sees(const Pads& pads, std::size_t line) {
  return (pads.inputs() & line_bit(line)) != 0;
}

TEST(Pads, AreFloatingAndReadLowWhileNothingIsConnected) {
  const Pads pads;
  EXPECT_EQ(pads.inputs(), 0U);
  for (std::size_t line = 0; line < kLines; ++line) {
    EXPECT_EQ(pads.state(line), PinState::floating);
    EXPECT_EQ(pads.voltage(line), 0);
  }
  EXPECT_EQ(pads.next_event(), base::SimTime::never());
}

TEST(Pads, FollowTheOutsideWhenTheChipDoesNotDrive) {
  Pads pads;
  for (std::size_t line = 0; line < kLines; ++line) {
    pads.drive(line, OutsideDrive::level(true));
    EXPECT_TRUE(sees(pads, line));
    EXPECT_EQ(pads.state(line), PinState::high);
    pads.drive(line, OutsideDrive::level(false));
    EXPECT_FALSE(sees(pads, line));
    EXPECT_EQ(pads.state(line), PinState::low);
  }
}

TEST(Pads, DriverWinsOverTheOutsideAndAWeakOneLoses) {
  Pads pads;
  pads.drive(hv(2), OutsideDrive::level(false));
  pads.command(hv(2), kHigh);
  EXPECT_EQ(pads.voltage(hv(2)), 24'000);
  pads.configure(0x0000'0400);  // weak high
  EXPECT_EQ(pads.voltage(hv(2)), 0);
  pads.drive(hv(2), {});
  EXPECT_EQ(pads.voltage(hv(2)), 24'000) << "a pull-up";
  pads.command(hv(2), kLow);
  pads.drive(hv(2), OutsideDrive::level(true));
  EXPECT_EQ(pads.voltage(hv(2)), 0) << "low is strong";
  pads.configure(0x0004'0000);  // weak low
  EXPECT_EQ(pads.voltage(hv(2)), 24'000);
}

TEST(Pads, SuppliesServeGroupsOfTwoThreeAndThree) {
  Pads pads;
  pads.set_supply(0, 5000);
  pads.set_supply(1, 12'000);
  pads.set_supply(2, 24'000);
  const std::int32_t expected[] = {5000, 5000, 12'000, 12'000, 12'000, 24'000, 24'000, 24'000};
  for (std::size_t pin = 0; pin < kHighVoltageLines; ++pin) {
    pads.command(hv(pin), kHigh);
    EXPECT_EQ(pads.voltage(hv(pin)), expected[pin]);
  }
  pads.command(0, kHigh);
  EXPECT_EQ(pads.voltage(0), 3300);
}

TEST(Pads, WithoutSupplyOutputsAreOffAndInputsLow) {
  Pads pads;
  pads.command(hv(0), kHigh);
  pads.drive(hv(1), OutsideDrive::voltage(24'000));
  EXPECT_TRUE(sees(pads, hv(1)));
  pads.set_supply(0, 2900);
  EXPECT_EQ(pads.state(hv(0)), PinState::floating);
  EXPECT_FALSE(sees(pads, hv(1)));
  pads.set_supply(0, 3000);
  EXPECT_EQ(pads.voltage(hv(0)), 3000);
  EXPECT_TRUE(sees(pads, hv(1)));
}

struct Threshold {
  std::int32_t supply;
  bool slow;
  std::int32_t rising;
  std::int32_t falling;
};

TEST(Pads, InputThresholdsFollowSupplyAndSlope) {
  const Threshold cases[] = {{5000, false, 1600, 800},
                             {5000, true, 2500, 2150},
                             {24'000, false, 12'000, 10'320},
                             {24'000, true, 12'000, 10'320}};
  for (const Threshold& expected : cases) {
    Pads pads;
    pads.configure(expected.slow ? 0x10 : 0);
    pads.set_supply(1, expected.supply);
    base::SimTime time;
    const auto level_at = [&](std::int32_t millivolts) {
      pads.drive(hv(4), OutsideDrive::voltage(millivolts));
      time += 10_us;
      pads.advance(time);
      return sees(pads, hv(4));
    };
    EXPECT_FALSE(level_at(expected.rising - 1)) << expected.supply;
    EXPECT_TRUE(level_at(expected.rising)) << expected.supply;
    EXPECT_TRUE(level_at(expected.falling)) << expected.supply;
    EXPECT_FALSE(level_at(expected.falling - 1)) << expected.supply;
  }
}

TEST(Pads, SlowInputsIgnoreSpikesShorterThanTheirFilter) {
  Pads pads;
  pads.configure(0x01);
  pads.advance(at(1_us));
  pads.drive(hv(0), OutsideDrive::level(true));
  EXPECT_EQ(pads.next_event(), at(2_us));
  pads.advance(at(1900_ns));
  pads.drive(hv(0), OutsideDrive::level(false));
  EXPECT_EQ(pads.next_event(), base::SimTime::never());
  pads.advance(at(3_us));
  EXPECT_FALSE(sees(pads, hv(0)));
  pads.drive(hv(0), OutsideDrive::level(true));
  pads.advance(at(3999_ns));
  EXPECT_FALSE(sees(pads, hv(0)));
  pads.advance(at(4_us));
  EXPECT_TRUE(sees(pads, hv(0)));
}

TEST(Pads, SlopesAreThoseOfTheDocument) {
  Pads pads;
  pads.configure(0x80);
  EXPECT_EQ(pads.slope(hv(7)), 200_ns);
  EXPECT_EQ(pads.slope(hv(6)), 20_ns);
}

TEST(Pads, DifferentialPairsCompareTheirPins) {
  Pads pads;
  pads.configure(0x0F00'0000);
  for (const DifferentialPair& pair : kDifferentialPairs) {
    pads.drive(pair.positive, OutsideDrive::voltage(2600));
    pads.drive(pair.negative, OutsideDrive::voltage(2400));
    EXPECT_TRUE(sees(pads, pair.negative)) << kLineNames[pair.negative];
    pads.drive(pair.positive, OutsideDrive::voltage(2400));
    EXPECT_TRUE(sees(pads, pair.negative)) << "equal voltages keep the level";
    pads.drive(pair.positive, OutsideDrive::voltage(2300));
    EXPECT_FALSE(sees(pads, pair.negative));
  }
}

TEST(Pads, AShortSwitchesTheDriverOffUntilItsLevelChanges) {
  Pads pads;
  pads.command(hv(3), kHigh);
  pads.set_short(hv(3), Short::to_ground);
  EXPECT_EQ(pads.status() & 0x00FF'FF00, 0U) << "it takes a time";
  EXPECT_EQ(pads.next_event(), at(10_us));
  pads.advance(at(10_us));
  EXPECT_EQ(pads.status(), 0x0000'0800U);
  EXPECT_FALSE(pads.driving(hv(3)));
  pads.set_short(hv(3), Short::none);
  pads.advance(at(1_ms));
  EXPECT_EQ(pads.status(), 0x0000'0800U) << "off as long as the polarity stays";
  pads.command(hv(3), kOff);
  pads.command(hv(3), kHigh);
  EXPECT_EQ(pads.voltage(hv(3)), 24'000);
  EXPECT_EQ(pads.status(), 0x0000'0008U) << "high voltage, no short";
}

TEST(Pads, AShortToSupplyIsFoundWhileDrivingLow) {
  Pads pads;
  pads.command(hv(5), kHigh);
  pads.set_short(hv(5), Short::to_supply);
  EXPECT_EQ(pads.next_event(), base::SimTime::never()) << "no current flows";
  pads.command(hv(5), kLow);
  pads.advance(at(20_us));
  EXPECT_EQ(pads.status(), 0x0020'0020U);
  pads.command(hv(5), kHigh);
  EXPECT_EQ(pads.status(), 0x0000'0020U);
}

TEST(Pads, WeakDriversSurviveAShort) {
  Pads pads;
  pads.configure(0x0000'FF00);
  pads.command(hv(0), kHigh);
  pads.set_short(hv(0), Short::to_ground);
  EXPECT_EQ(pads.next_event(), base::SimTime::never());
}

TEST(Pads, ResetLeavesTheOutsideAsItIs) {
  Pads pads;
  pads.configure(0x0F00'FFFF);
  pads.command(4, kHigh);
  pads.drive(5, OutsideDrive::level(true));
  pads.reset();
  EXPECT_EQ(pads.state(4), PinState::floating);
  EXPECT_TRUE(sees(pads, 5));
}

}  // namespace
}  // namespace stator::mfc
