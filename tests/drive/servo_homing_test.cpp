// Homing of a servo axis: by limit switch, at the present position, and on hard stops as
// homing_methods.csv and homing_hardstop_steps.csv have them.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "drive/servo_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

class ServoHoming : public testing::Test {
 protected:
  ServoHoming() {
    bench_.write(0x6099, 1, 600);
    bench_.write(0x6099, 2, 120);
    bench_.write(0x609A, 5000);
  }
  void begin(int method) {
    bench_.write(0x6098, method);
    bench_.enable(ModeCode::homing);
    bench_.write(0x6040, 0x1F);
  }
  [[nodiscard]] bool attained(base::SimDuration longest = 30_s) {
    return bench_.pass_until([&] { return home_bits() == kBoth; }, longest);
  }
  [[nodiscard]] unsigned home_bits() const {
    return static_cast<unsigned>(bench_.read(0x6041)) & kBoth;
  }
  static constexpr unsigned kBoth = statusword::kTargetReached | statusword::kHomeAttained;
  ServoBench bench_;
};

TEST_F(ServoHoming, Method17FindsTheReleaseOfTheLeftSwitch) {
  bench_.left_switch = -40'000;
  begin(17);
  EXPECT_EQ(home_bits(), 0U);
  bench_.pass(500_ms);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x606C)), -600.0, 60.0) << "6099h:01 first";
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.sensing.left_switch; }, 10_s));
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.axis->motion().velocity() > 0.0; }, 2_s));
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.axis->motion().velocity() * 60.0 / 4000.0, 120.0, 1.0) << "6099h:02 back";
  ASSERT_TRUE(attained());
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.motor.counts(), -40'000.0, 5.0);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 2.0);
  EXPECT_NEAR(static_cast<double>(bench_.axis->home_offset_display()), -40'000.0, 5.0);
  EXPECT_TRUE(bench_.axis->errors().empty()) << "switches tell nothing while homing";
}

TEST_F(ServoHoming, Method18FindsTheReleaseOfTheRightSwitch) {
  bench_.right_switch = 6000;
  begin(18);
  ASSERT_TRUE(attained());
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.motor.counts(), 6000.0, 5.0);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 2.0);
}

TEST_F(ServoHoming, TheHomeOffsetIsSubtractedFromHome) {
  bench_.left_switch = -4000;
  bench_.write(0x607C, 1000);
  begin(17);
  ASSERT_TRUE(attained());
  bench_.pass(1_s);
  EXPECT_NEAR(static_cast<double>(bench_.position()), -1000.0, 2.0);
}

TEST_F(ServoHoming, ADisabledSwitchIsWaitedFor) {
  bench_.left_switch = -1000;
  bench_.axis->settings().reference.switches.left.used = false;
  begin(17);
  bench_.pass(2_s);
  EXPECT_EQ(home_bits(), 0U);
  EXPECT_LT(bench_.motor.counts(), -3000.0);
}

TEST_F(ServoHoming, AnInvertedSwitchIsPressedWhenItsLevelIsLow) {
  bench_.axis->settings().reference.switches.left.inverted = true;
  bench_.left_switch = 1e9;  // high wherever the shaft goes, until it is
  begin(17);
  bench_.pass(200_ms);
  bench_.left_switch = -1e9;
  bench_.pass(200_ms);
  EXPECT_GT(bench_.axis->motion().velocity(), 0.0) << "it has turned round";
}

TEST_F(ServoHoming, Method35NamesThePresentPositionWithoutBeingEnabled) {
  bench_.motor.turn_to(1234.0);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.position(), 1234);
  bench_.write(0x6060, 6);
  bench_.write(0x6098, 35);
  bench_.write(0x6040, 0x10);
  bench_.pass(1_ms);
  EXPECT_EQ(home_bits(), kBoth);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
  for (const unsigned object : {0x6062U, 0x6063U, 0x6064U}) {
    EXPECT_EQ(bench_.read(static_cast<std::uint16_t>(object)), 0);
  }
  EXPECT_EQ(bench_.axis->home_offset_display(), 1234);
}

TEST_F(ServoHoming, Method35IsExactlyZeroWhileEnabledToo) {
  bench_.write(0x607C, 77);
  begin(35);
  bench_.pass(1_ms);
  EXPECT_EQ(home_bits(), kBoth);
  EXPECT_EQ(bench_.position(), 0);
}

TEST_F(ServoHoming, Method35NamesThePositionWhenTheMotorStands) {
  bench_.left_switch = -1e6;
  begin(17);
  bench_.pass(400_ms);
  ASSERT_LT(bench_.rpm(), -500.0);
  bench_.write(0x6098, 35);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6040, 0x1F);
  EXPECT_EQ(home_bits(), 0U) << "it still turns";
  ASSERT_TRUE(attained(1_s));
  EXPECT_NEAR(bench_.rpm(), 0.0, 30.0);
  const double named = bench_.motor.counts();
  bench_.pass(500_ms);
  EXPECT_NEAR(bench_.motor.counts(), named, 30.0) << "the demand has not jumped";
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(ServoHoming, ItStartsWhereBitFourRisesInItsModeOnly) {
  bench_.left_switch = -4000;
  bench_.write(0x6098, 17);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x6040, 0x1F);
  bench_.write(0x6060, 6);
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.read(0x6061), 6);
  EXPECT_FALSE(bench_.axis->homing()) << "bit 4 was set in pp";
  bench_.write(0x6040, 0x17);
  bench_.write(0x6040, 0x1F);
  bench_.pass(200_ms);
  EXPECT_FALSE(bench_.axis->homing()) << "nor does enabling make it rise";
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6040, 0x1F);
  EXPECT_TRUE(bench_.axis->homing());
  EXPECT_TRUE(attained());
}

TEST_F(ServoHoming, MethodZeroDoesNothing) {
  begin(0);
  bench_.pass(100_ms);
  EXPECT_EQ(home_bits(), 0U);
  EXPECT_EQ(bench_.read(0x6062), 0);
}

TEST_F(ServoHoming, BitFourStopsOnTheRampOfHoming) {
  bench_.left_switch = -1e6;
  begin(17);
  bench_.pass(400_ms);
  bench_.write(0x6040, 0x0F);
  EXPECT_FALSE(bench_.axis->homing());
  bench_.pass(50_ms);
  EXPECT_NEAR(bench_.axis->motion().velocity() * 60.0 / 4000.0, -350.0, 20.0) << "5000 rpm/s";
  bench_.pass(500_ms);
  EXPECT_EQ(home_bits(), statusword::kTargetReached);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(ServoHoming, HaltIsNotLookedAt) {
  bench_.left_switch = -4000;
  begin(17);
  bench_.write(0x6040, 0x11F);
  EXPECT_TRUE(attained());
}

TEST_F(ServoHoming, AStartForgetsTheRunBefore) {
  bench_.left_switch = -4000;
  begin(17);
  ASSERT_TRUE(attained());
  bench_.write(0x6098, 0);
  bench_.write(0x6040, 0x0F);
  EXPECT_EQ(home_bits(), kBoth);
  bench_.write(0x6040, 0x1F);
  EXPECT_EQ(home_bits(), 0U);
}

TEST_F(ServoHoming, WithoutAnAccelerationItDoesNotStartAndSaysWhy) {
  bench_.write(0x609A, 0);
  begin(17);
  bench_.pass(100_ms);
  EXPECT_FALSE(bench_.axis->homing());
  EXPECT_TRUE(bench_.told("homing method 17 not started: 609Ah is 0"));
}

TEST_F(ServoHoming, WithoutSpeedsItDoesNotStartAndSaysWhy) {
  bench_.write(0x6099, 1, 0);
  begin(17);
  bench_.pass(100_ms);
  EXPECT_EQ(home_bits(), 0U);
  EXPECT_FALSE(bench_.axis->homing());
  EXPECT_TRUE(bench_.told("homing method 17 not started: 6099h is 0 and 120 rpm"));
}

class ServoHardStop : public ServoHoming {
 protected:
  ServoHardStop() {
    bench_.motor.lower_stop = -6000.0;
    bench_.motor.upper_stop = 10'000.0;
    HardStopSettings& settings = bench_.axis->settings().hard_stop;
    settings = {.current = 1.0, .positive_clearance = 500, .negative_clearance = 300};
    bench_.write(0x607D, 1, -7777);
    bench_.write(0x607D, 2, 7777);
  }
  void expect_counts(double expected) {
    bench_.pass(1_s);
    EXPECT_NEAR(bench_.motor.counts(), expected, 8.0);
  }
};

TEST_F(ServoHardStop, Method1StandsAtZeroInFrontOfThePositiveStop) {
  begin(-1);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.motor.counts() > 1000.0; }, 2_s));
  EXPECT_NEAR(bench_.axis->set_point().velocity, 120.0, 1.0) << "searched with 6099h:02";
  EXPECT_EQ(bench_.axis->set_point().loop, control::ServoLoop::velocity);
  ASSERT_TRUE(attained());
  expect_counts(9500.0);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 2.0);
  EXPECT_EQ(bench_.read(0x607D, 2), 0);
  EXPECT_EQ(bench_.read(0x607D, 1), -7777);
}

TEST_F(ServoHardStop, Method2StandsAtZeroInFrontOfTheNegativeStop) {
  begin(-2);
  ASSERT_TRUE(attained());
  expect_counts(-5700.0);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 2.0);
  EXPECT_EQ(bench_.read(0x607D, 1), 0);
  EXPECT_EQ(bench_.read(0x607D, 2), 7777);
}

TEST_F(ServoHardStop, Method3SetsBothLimitsAndEndsAtTheLowerOne) {
  begin(-3);
  ASSERT_TRUE(attained());
  expect_counts(-5700.0);
  EXPECT_EQ(bench_.read(0x607D, 2), 0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x607D, 1)), -15'200.0, 10.0);
  EXPECT_NEAR(static_cast<double>(bench_.position() - bench_.read(0x607D, 1)), 0.0, 6.0);
}

TEST_F(ServoHardStop, Method4SetsBothLimitsAndEndsAtTheUpperOne) {
  begin(-4);
  ASSERT_TRUE(attained());
  expect_counts(9500.0);
  EXPECT_EQ(bench_.read(0x607D, 1), 0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x607D, 2)), 15'200.0, 10.0);
}

TEST_F(ServoHardStop, Method5ScalesTheWayTo65535BelowZero) {
  begin(-5);
  ASSERT_TRUE(attained());
  expect_counts(-5700.0);
  EXPECT_EQ(bench_.read(0x607D, 1), -65535);
  EXPECT_EQ(bench_.read(0x607D, 2), 0);
  EXPECT_NEAR(static_cast<double>(bench_.position()), -65535.0, 25.0);
  EXPECT_NEAR(bench_.axis->position_scale(), 65535.0 / 15'200.0, 0.01);
}

TEST_F(ServoHardStop, Method6ScalesTheWayTo65535AndPositionsCountScaled) {
  begin(-6);
  ASSERT_TRUE(attained());
  EXPECT_EQ(bench_.read(0x607D, 1), 0);
  EXPECT_EQ(bench_.read(0x607D, 2), 65535);
  bench_.set_profile(1000, 10'000, 10'000);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6060, 1);
  bench_.pass(5_ms);
  bench_.write(0x607A, 32'768);
  bench_.start();
  bench_.pass(3_s);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 32'768.0, 15.0);
  EXPECT_NEAR(static_cast<double>(bench_.read(0x6062)), 32'768.0, 5.0);
  EXPECT_NEAR(bench_.motor.counts(), -5700.0 + 7600.0, 10.0);
  bench_.write(0x607A, 70'000);
  bench_.start();
  bench_.pass(3_s);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_NEAR(static_cast<double>(bench_.position()), 65'535.0, 15.0);
}

TEST_F(ServoHardStop, AnotherMethodEndsTheScaling) {
  begin(-6);
  ASSERT_TRUE(attained());
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6098, 35);
  bench_.write(0x6040, 0x1F);
  EXPECT_EQ(bench_.axis->position_scale(), 1.0);
}

TEST_F(ServoHardStop, TheSearchIsNotFasterThanTheFastSpeed) {
  bench_.write(0x6099, 1, 60);
  begin(-1);
  bench_.pass(500_ms);
  EXPECT_NEAR(bench_.axis->set_point().velocity, 60.0, 1.0);
}

TEST_F(ServoHardStop, TheReturnUsesTheFastSpeed) {
  bench_.axis->settings().hard_stop.positive_clearance = 8000;
  begin(-1);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.rpm() < -100.0; }, 20_s));
  double slowest = 0.0;
  ASSERT_TRUE(bench_.pass_until(
      [&] {
        slowest = std::min(slowest, bench_.axis->motion().velocity() * 60.0 / 4000.0);
        return home_bits() == kBoth;
      },
      10_s));
  EXPECT_NEAR(slowest, -600.0, 1.0);
}

/// As one does whose magnets pull it away from the goal on either side.
TEST_F(ServoHardStop, AShaftThatDoesNotComeToRestOnItsGoalEndsTheWayBackToo) {
  begin(-1);
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.rpm() < -100.0; }, 20_s));
  double phase = 0.0;
  EXPECT_TRUE(bench_.pass_until(
      [&] {
        phase += 0.05;
        bench_.motor.load = std::sin(phase) < 0.0 ? -0.05 : 0.05;
        return home_bits() == kBoth;
      },
      10_s));
  EXPECT_NEAR(bench_.motor.counts(), 9500.0, 50.0);
  EXPECT_NEAR(bench_.motor.counts() - static_cast<double>(bench_.position()), 9500.0, 8.0);
}

TEST_F(ServoHardStop, SwitchesAreIgnored) {
  bench_.right_switch = 2000.0;
  begin(-1);
  ASSERT_TRUE(attained());
  expect_counts(9500.0);
}

TEST_F(ServoHardStop, WithoutAThresholdItDoesNotStartAndSaysWhy) {
  bench_.axis->settings().hard_stop.current = 0.0;
  begin(-1);
  bench_.pass(100_ms);
  EXPECT_EQ(home_bits(), 0U);
  EXPECT_EQ(bench_.read(0x6062), 0);
  EXPECT_TRUE(bench_.told("the current that tells a hard stop is 0 mA"));
}

TEST_F(ServoHardStop, AHighThresholdIsNotReachedByTheTravelAlone) {
  bench_.motor.upper_stop.reset();
  begin(-1);
  bench_.pass(5_s);
  EXPECT_EQ(home_bits(), 0U);
  EXPECT_GT(bench_.motor.counts(), 30'000.0);
}

TEST_F(ServoHardStop, AShortPeakOfCurrentIsNoStop) {
  bench_.motor.upper_stop.reset();
  begin(-1);
  bench_.pass(1_s);
  bench_.motor.blocked = true;
  bench_.pass(2_ms);
  bench_.motor.blocked = false;
  bench_.pass(1_s);
  EXPECT_TRUE(bench_.axis->homing());
  EXPECT_EQ(bench_.axis->set_point().loop, control::ServoLoop::velocity);
}

TEST_F(ServoHardStop, AfterwardsTheMotorMovesWithinTheLimits) {
  begin(-4);
  ASSERT_TRUE(attained());
  bench_.set_profile(1000, 10'000, 10'000);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6060, 1);
  bench_.pass(5_ms);
  bench_.write(0x607A, -5000);
  bench_.start();
  bench_.pass(4_s);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 2.0);
}

TEST_F(ServoHardStop, BitFourEndsTheSearch) {
  begin(-1);
  bench_.pass(500_ms);
  bench_.write(0x6040, 0x0F);
  bench_.pass(2_s);
  EXPECT_EQ(home_bits(), statusword::kTargetReached);
  EXPECT_LT(bench_.motor.counts(), 9000.0);
  EXPECT_EQ(bench_.read(0x607D, 2), 7777);
}

}  // namespace
}  // namespace stator::drive
