// What happens to a homing on its way: start, stop, faults, limits, offset.

#include "stator/drive/modes/homing_mode.hpp"

#include <gtest/gtest.h>

#include "drive/axis_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

constexpr std::int64_t kFar = 1'000'000'000;
constexpr std::uint16_t kBoth = statusword::kTargetReached | statusword::kHomeAttained;

/// Method 19; the axis stands at 0, the home switch is pressed from 20000 on, seen released at
/// 19999.
class HomingModeTest : public testing::Test {
 protected:
  HomingModeTest() {
    bench_.home_switch = {20'000, kFar};
    bench_.write(0x6098, 19);
    bench_.write(0x6099, 1, 50'000);
    bench_.write(0x6099, 2, 10'000);
    bench_.write(0x609A, 500'000);
    bench_.write(0x6084, 50'000);
    bench_.enable(ModeCode::homing);
  }
  void start() { bench_.write(0x6040, 0x1F); }
  /// Bits 10 and 12.
  [[nodiscard]] unsigned bits() const { return static_cast<unsigned>(bench_.read(0x6041)) & kBoth; }

  AxisBench bench_;
};

TEST_F(HomingModeTest, StatusBitsTellTheOutcomeUntilTheNextStart) {
  EXPECT_EQ(bits(), 0U) << "nothing has happened yet";
  start();
  bench_.pass(5_ms);
  EXPECT_EQ(bits(), 0U);
  EXPECT_TRUE(bench_.status(statusword::kMotorActivity));
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  bench_.write(0x6040, 0x0F);
  bench_.pass(1_s);
  EXPECT_EQ(bits(), kBoth) << "kept with bit 4 = 0";
  start();
  EXPECT_EQ(bits(), 0U) << "a new start clears them";
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_FALSE(bench_.status(statusword::kFollowingError)) << "bit 13 is not supported";
}

TEST_F(HomingModeTest, AFinishedHomingStartsAgainOnlyAfterBit4WasCleared) {
  start();
  bench_.pass(3_s);
  ASSERT_EQ(bits(), kBoth);
  bench_.home_switch = {40'000, kFar};
  start();
  bench_.pass(3_s);
  EXPECT_EQ(bench_.shaft(), 19'999);
  bench_.write(0x6040, 0x0F);
  start();
  bench_.pass(3_s);
  EXPECT_EQ(bench_.shaft(), 39'999);
}

TEST_F(HomingModeTest, ClearingBit4StopsWithTheHomingAcceleration) {
  start();
  bench_.pass(200_ms);
  ASSERT_EQ(bench_.velocity(), 50'000.0);
  bench_.write(0x6040, 0x0F);
  bench_.pass(50_ms);
  EXPECT_NEAR(bench_.velocity(), 25'000.0, 1.0) << "609Ah, not 6084h";
  EXPECT_EQ(bits(), 0U) << "not stopped yet";
  bench_.pass(60_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_EQ(bits(), statusword::kTargetReached);
  const std::int64_t stopped = bench_.shaft();
  EXPECT_EQ(bench_.read(0x6064), stopped) << "positions are what they were";
  bench_.pass(1_s);
  EXPECT_EQ(bench_.shaft(), stopped);
  start();
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth) << "and it can be started again";
  EXPECT_EQ(bench_.shaft(), 19'999);
}

TEST_F(HomingModeTest, StartAndStopAreLevels) {
  bench_.write(0x6040, 0x0000);
  for (const int controlword : {0x16, 0x17, 0x1F}) {
    bench_.write(0x6040, controlword);
  }
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth) << "bit 4 was 1 when the drive became enabled";
}

TEST_F(HomingModeTest, HaltIsNotLookedAt) {
  bench_.write(0x6040, 0x011F);
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth);
}

TEST_F(HomingModeTest, NothingMovesWithoutSpeedOrAcceleration) {
  for (const auto& [index, subindex] :
       {std::pair<std::uint16_t, std::uint8_t>{0x6099, 1}, {0x609A, 0}}) {
    const std::int64_t value = bench_.read(index, subindex);
    bench_.write(index, subindex, 0);
    start();
    bench_.pass(1_s);
    EXPECT_EQ(bench_.shaft(), 0);
    EXPECT_EQ(bits(), 0U);
    bench_.write(0x6040, 0x0F);
    bench_.write(index, subindex, value);
  }
  bench_.write(0x6099, 2, 0);
  start();
  bench_.pass(3_s);
  EXPECT_GT(bench_.shaft(), 20'000) << "the switch is found, but not left";
  EXPECT_EQ(bits(), 0U);
  bench_.write(0x6099, 2, 10'000);
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth) << "speeds act in flight";
}

TEST_F(HomingModeTest, ARunIsForgottenByAFaultAndStartsAnew) {
  bench_.write(0x6040, 0);
  bench_.write(0x606A, 0);
  bench_.write(0x6065, 500);
  bench_.enable(ModeCode::homing);
  start();
  bench_.pass(200_ms);
  bench_.blocked = true;
  bench_.pass(2_s);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault);
  EXPECT_EQ(bits(), statusword::kTargetReached) << "stopped before home";
  bench_.blocked = false;
  bench_.write(0x6040, 0x0080);
  bench_.enable(ModeCode::homing);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 0.0) << "bit 4 is 0";
  start();
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_NEAR(static_cast<double>(bench_.shaft()), 19'999.0, 1.0);
}

TEST_F(HomingModeTest, LosingTheNetworkStopsOnTheQuickStopRamp) {
  start();
  bench_.pass(200_ms);
  bench_.axis->network_left_operational(bench_.now);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.velocity(), 50'000.0 - 5120.0, 1.0) << "6085h = 51200";
  bench_.pass(2_s);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
  EXPECT_EQ(bits(), statusword::kTargetReached);
}

TEST_F(HomingModeTest, SlowDownOptionsUseTheHomingAcceleration) {
  bench_.write(0x605A, 1);
  start();
  bench_.pass(200_ms);
  bench_.write(0x6040, 0x0002);
  bench_.pass(50_ms);
  EXPECT_NEAR(bench_.velocity(), 25'000.0, 1.0);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
}

TEST_F(HomingModeTest, AQuickStopTakesItsOwnRamp) {
  start();
  bench_.pass(200_ms);
  bench_.write(0x6040, 0x0002);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.velocity(), 50'000.0 - 5120.0, 1.0) << "6085h = 51200";
}

TEST_F(HomingModeTest, ChoosingAnotherModeStopsTheRun) {
  start();
  bench_.pass(200_ms);
  bench_.write(0x6060, 1);
  bench_.pass(50_ms);
  EXPECT_NEAR(bench_.velocity(), 25'000.0, 1.0) << "slow-down ramp of homing";
  EXPECT_EQ(bench_.read(0x6061), 6);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.read(0x6061), 1);
  bench_.pass(2_s);
  EXPECT_LT(bench_.shaft(), 20'000);
}

// Limits

TEST_F(HomingModeTest, SoftwareLimitsDoNotHold) {
  bench_.write(0x607D, 1, -100);
  bench_.write(0x607D, 2, 100);
  start();
  bench_.pass(3_s);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_EQ(bench_.shaft(), 19'999);
  EXPECT_TRUE(bench_.axis->errors().empty());
  EXPECT_TRUE(bench_.sentences.empty());
}

TEST_F(HomingModeTest, SoftwareLimitsHoldFromTheNewHomeOn) {
  bench_.write(0x607C, 5000);
  bench_.write(0x607D, 1, -1000);
  bench_.write(0x607D, 2, 8000);
  start();
  bench_.pass(3_s);
  bench_.set_profile(50'000, 500'000, 500'000);
  bench_.enable(ModeCode::profile_position);
  const auto move_to = [&](std::int64_t target) {
    bench_.write(0x607A, target);
    bench_.write(0x6040, 0x1F);
    bench_.write(0x6040, 0x0F);
    bench_.pass(2_s);
  };
  move_to(1'000'000);
  EXPECT_EQ(bench_.read(0x6064), 3000) << "8000 - 607Ch";
  EXPECT_EQ(bench_.shaft(), 19'999 + 8000) << "8000 from machine home";
  move_to(-1'000'000);
  EXPECT_EQ(bench_.read(0x6064), -6000);
  EXPECT_EQ(bench_.shaft(), 19'999 - 1000);
}

TEST_F(HomingModeTest, LimitSwitchesAreNotReported) {
  bench_.home_switch = {-30'000, -25'000};
  bench_.right_switch = {10'000, kFar};
  start();
  bench_.pass(10_s);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_EQ(bench_.shaft(), -30'001) << "after reversing at the limit switch";
  EXPECT_TRUE(bench_.axis->errors().empty());
  EXPECT_TRUE(bench_.sentences.empty());
}

TEST_F(HomingModeTest, ALimitSwitchTheMethodDoesNotNameStopsTheMotor) {
  struct Case {
    int method;
    AxisBench::Cam left;
    AxisBench::Cam right;
    double stopped;
  };
  constexpr AxisBench::Cam kNever{kFar, kFar};
  for (const Case& c :
       {Case{3, kNever, {10'000, 12'000}, 10'000.0},             // searching
        Case{33, {-12'000, -10'000}, kNever, -10'000.0},         // for the index
        Case{17, {-kFar, 15'000}, {10'000, kFar}, 10'000.0}}) {  // leaving the other
    AxisBench bench;
    bench.home_switch = kNever;
    bench.left_switch = c.left;
    bench.right_switch = c.right;
    bench.write(0x606A, 0);
    bench.write(0x6098, c.method);
    bench.write(0x6099, 1, 20'000);
    bench.write(0x6099, 2, 20'000);
    bench.write(0x609A, 500'000);
    bench.enable(ModeCode::homing);
    bench.write(0x6040, 0x1F);
    bench.pass(2_s);
    EXPECT_NEAR(static_cast<double>(bench.shaft()), c.stopped, 20.0) << "method " << c.method;
    EXPECT_EQ(bench.velocity(), 0.0);
    EXPECT_TRUE(bench.status(statusword::kInternalLimit)) << "method " << c.method;
    EXPECT_FALSE(bench.status(statusword::kTargetReached)) << "homing waits for bit 4";
    EXPECT_TRUE(bench.axis->errors().empty());
    bench.write(0x6040, 0x0F);
    EXPECT_TRUE(bench.status(statusword::kTargetReached)) << "method " << c.method;
  }
}

TEST_F(HomingModeTest, AfterAStopAtALimitSwitchTheStopDecelerationHolds) {
  bench_.axis->settings().ramp.stop_deceleration = 100'000.0;
  bench_.write(0x6098, 3);
  bench_.right_switch = {10'000, kFar};
  bench_.home_switch = {kFar, kFar};
  start();
  for (int i = 0; i < 1000 && bench_.shaft() < 10'000; ++i) {
    bench_.pass(1_ms);
  }
  const double velocity = bench_.velocity();
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.velocity(), velocity - 10'000.0, 200.0) << "2014h, not 609Ah";
}

TEST_F(HomingModeTest, WithoutItsSwitchTheSearchRunsOnUntilStopped) {
  bench_.axis->settings().reference.switches.home.used = false;
  start();
  bench_.pass(30_s);
  EXPECT_EQ(bench_.velocity(), 50'000.0);
  EXPECT_GT(bench_.shaft(), 1'400'000);
  bench_.write(0x6040, 0x0F);
  bench_.pass(1_s);
  EXPECT_EQ(bits(), statusword::kTargetReached);
}

TEST_F(HomingModeTest, WithoutAnEncoderAnIndexNeverComes) {
  bench_.index_mark = 5000;
  bench_.write(0x6098, 34);
  start();
  bench_.pass(20_s);
  EXPECT_EQ(bench_.velocity(), 10'000.0);
  EXPECT_EQ(bits(), 0U);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6098, 3);
  bench_.home_switch = {-100'000, kFar};
  start();
  bench_.pass(60_s);
  EXPECT_EQ(bench_.velocity(), -10'000.0) << "the switch is left, the pulse is waited for";
  EXPECT_LT(bench_.shaft(), -150'000);
}

TEST_F(HomingModeTest, AnInvertedSwitchIsPressedWhenItsSignalIsLow) {
  bench_.axis->settings().reference.switches.home.inverted = true;
  bench_.home_switch = {-kFar, 30'000};
  start();
  bench_.pass(5_s);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_EQ(bench_.shaft(), 30'000);
}

// Offset and positions

TEST_F(HomingModeTest, AtHomeThePositionIsTheNegativeOffset) {
  for (const std::int64_t offset : {2000, -2000}) {
    bench_.write(0x607C, offset);
    start();
    bench_.pass(5_s);
    EXPECT_EQ(bench_.shaft(), 19'999);
    EXPECT_TRUE(bench_.all_positions_are(-offset));
    bench_.write(0x6040, 0x0F);
  }
}

TEST_F(HomingModeTest, TheSignOfTheOffsetIsAChoice) {
  bench_.axis->settings().reference.home_offset_is_position = true;
  bench_.write(0x607C, 2000);
  start();
  bench_.pass(3_s);
  EXPECT_EQ(bench_.read(0x6064), 2000);
}

TEST_F(HomingModeTest, PositionsAreRenamedWhenHomingHasFinished) {
  start();
  bench_.pass(300_ms);
  EXPECT_EQ(bench_.read(0x6064), bench_.shaft()) << "old coordinates on the way";
  bench_.pass(3_s);
  EXPECT_EQ(bench_.read(0x6064), 0);
}

TEST_F(HomingModeTest, ThePresentPositionBecomesZeroWhateverTheOffset) {
  start();
  bench_.pass(100_ms);
  bench_.write(0x6040, 0);
  bench_.pass(10_ms);
  ASSERT_NE(bench_.read(0x6064), 0);
  const std::int64_t shaft = bench_.shaft();
  bench_.write(0x607C, 500);
  bench_.write(0x6098, 35);
  bench_.write(0x6040, 0x0010);
  EXPECT_EQ(bits(), kBoth) << "in Switch on disabled";
  bench_.pass(1_ms);
  EXPECT_TRUE(bench_.all_positions_are(0));
  EXPECT_EQ(bench_.shaft(), shaft);
}

TEST_F(HomingModeTest, ASwitchPressedByHandIsLeftWhereItIsReleased) {
  bench_.home_switch = {kFar, kFar};
  start();
  bench_.pass(500_ms);
  bench_.home_switch = {-kFar, kFar};
  bench_.pass(500_ms);
  EXPECT_EQ(bench_.velocity(), -10'000.0);
  const std::int64_t released = bench_.shaft();
  bench_.home_switch = {kFar, kFar};
  bench_.pass(200_ms);
  EXPECT_EQ(bits(), kBoth);
  EXPECT_NEAR(static_cast<double>(bench_.shaft() - released), 0.0, 1.0);
}

}  // namespace
}  // namespace stator::drive
