// Software limits, limit switches and the end of the position counter.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include <gtest/gtest.h>

#include "drive/axis_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

constexpr std::int64_t kCounterEnd = 2'147'483'647;
constexpr double kDeceleration = 40'000.0;  // pps/s

void choose_bows(AxisBench& bench) {
  bench.write(0x6086, 1);
  for (std::uint8_t i = 1; i <= 4; ++i) {
    bench.write(0x60A4, i, 400'000);
  }
}

/// Mode, 6086h, and when in a control period the targets are written.
class VelocityStream
    : public testing::TestWithParam<std::tuple<ModeCode, std::int64_t, base::SimDuration>> {
 protected:
  static constexpr double kLimit = 50'000.0;

  VelocityStream() {
    bench_.set_profile(0, 20'000, static_cast<std::int64_t>(kDeceleration));
    if (std::get<1>(GetParam()) == 1) {
      choose_bows(bench_);
    }
    bench_.write(0x607D, 2, static_cast<std::int64_t>(kLimit));
    bench_.pass(std::get<2>(GetParam()));
    bench_.enable(std::get<0>(GetParam()));
  }
  /// A new target every millisecond, never the same twice in a row.
  void stream(std::int64_t velocity, int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) {
      bench_.write(0x60FF, velocity + i % 2);
      for (int step = 0; step < 20; ++step) {
        const double before = bench_.velocity();
        bench_.pass(50_us);
        furthest_ = std::max(furthest_, bench_.position());
        hardest_ = std::max(hardest_, (before - bench_.velocity()) / 50e-6);
      }
    }
  }
  AxisBench bench_;
  double furthest_ = 0.0;
  double hardest_ = 0.0;  ///< deceleration, pps/s
};

TEST_P(VelocityStream, ThatGoesOnRestsExactlyAtTheLimitOnItsRamp) {
  stream(20'000, 6000);
  EXPECT_EQ(furthest_, kLimit);
  EXPECT_EQ(bench_.position(), kLimit);
  EXPECT_LT(hardest_, kDeceleration * 1.01);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_TRUE(bench_.sentences.empty()) << bench_.sentences.front();
}

TEST_P(VelocityStream, ThatTurnsRoundBeforeTheLimitIsFollowed) {
  while (bench_.position() < kLimit - 3000.0) {
    stream(20'000, 1);
  }
  ASSERT_TRUE(bench_.status(statusword::kInternalLimit)) << "it brakes already";
  stream(-5000, 2000);
  EXPECT_NEAR(bench_.velocity(), -5000.0, 1.0);
  EXPECT_LE(furthest_, kLimit + 1e-6) << "but for rounding";
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
}

TEST_P(VelocityStream, IsFollowedAgainWhenTheLimitMovesAway) {
  while (bench_.position() < kLimit - 3000.0) {
    stream(20'000, 1);
  }
  bench_.write(0x607D, 2, 1'000'000);
  stream(20'000, 2000);
  EXPECT_NEAR(bench_.velocity(), 20'000.0, 1.0);
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
}

INSTANTIATE_TEST_SUITE_P(Axis, VelocityStream,
                         testing::Combine(testing::Values(ModeCode::profile_velocity,
                                                          ModeCode::cyclic_synchronous_velocity),
                                          testing::Values(0, 1), testing::Values(0_us, 450_us)));

class AxisLimits : public testing::Test {
 protected:
  /// Takes the axis to `position` at once, with a shaft that stays where it is.
  void stand_at(std::int64_t position) {
    bench_.blocked = true;
    bench_.enable(ModeCode::cyclic_synchronous_position);
    bench_.write(0x607A, position);
    bench_.pass(3_ms);
    ASSERT_EQ(motion().position(), position);
    bench_.write(0x6060, 0);
  }
  [[nodiscard]] const AxisMotion& motion() const { return bench_.axis->motion(); }
  AxisBench bench_;
};

TEST_F(AxisLimits, AVelocityThatStartsCloseToTheLimitIsCutDownToIt) {
  bench_.set_profile(0, 4'000'000, 40'000);
  bench_.write(0x607D, 2, 300);
  for (const ModeCode mode : {ModeCode::profile_velocity, ModeCode::cyclic_synchronous_velocity}) {
    bench_.enable(mode);
    bench_.write(0x60FF, 20'000);
    bench_.pass(1_s);
    EXPECT_EQ(bench_.position(), 300.0);
    EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
    bench_.write(0x60FF, 0);
    EXPECT_FALSE(bench_.status(statusword::kInternalLimit)) << "to stand there is allowed";
    bench_.write(0x6060, 0);
    bench_.pass(10_ms);
    bench_.write(0x607D, 2, 600 - 300);
  }
  EXPECT_TRUE(bench_.sentences.empty());
}

TEST_F(AxisLimits, AReversalSlowerThanTheWayAllowsIsFollowedAfterBraking) {
  bench_.set_profile(0, 20'000, 40'000);
  bench_.write(0x607D, 2, 20'000);
  bench_.write(0x60C2, 1, 200);
  bench_.enable(ModeCode::cyclic_synchronous_velocity);
  bench_.write(0x60FF, 20'000);
  while (bench_.position() < 20'000.0 - 4000.0) {
    bench_.pass(1_ms);
  }
  bench_.write(0x60C2, 2, -1);  // now 20 s
  bench_.write(0x60FF, -1000);
  double furthest = 0.0;
  for (int i = 0; i < 40'000; ++i) {
    bench_.pass(1_ms);
    furthest = std::max(furthest, bench_.position());
  }
  EXPECT_LE(furthest, 20'000.0);
  EXPECT_NEAR(bench_.velocity(), -1000.0, 1.0);
}

TEST_F(AxisLimits, OutsideThemACyclicAxisIsNotPulledBackButMayReturn) {
  bench_.enable(ModeCode::cyclic_synchronous_position);
  bench_.write(0x607A, 500);
  bench_.pass(2_ms);
  bench_.write(0x607D, 2, 100);
  bench_.write(0x607A, 510);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.position(), 500.0);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x607A, 490);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.position(), 490.0);
  bench_.write(0x607A, 90);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.position(), 90.0);
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
}

TEST_F(AxisLimits, WithALimitOnOneSideTheCounterEndsTheOther) {
  for (const std::int64_t sign : {1, -1}) {
    bench_.write(0x607D, 1, -kCounterEnd - 1);
    bench_.write(0x607D, 2, kCounterEnd);
    stand_at(0);
    const std::int64_t end = sign > 0 ? kCounterEnd : -kCounterEnd - 1;
    stand_at(end - sign * 5000);
    bench_.write(0x607D, sign > 0 ? 1 : 2, -sign * 1000);
    bench_.set_profile(0, 20'000, 40'000);
    bench_.enable(ModeCode::profile_velocity);
    bench_.write(0x60FF, sign * 10'000);
    bench_.pass(3_s);
    EXPECT_EQ(motion().position(), end);
    EXPECT_EQ(bench_.read(0x6062), end);
    EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
    EXPECT_EQ(sign > 0 ? motion().lower_limit() : motion().upper_limit(), -sign * 1000);
    EXPECT_TRUE(bench_.sentences.empty());
  }
}

TEST_F(AxisLimits, ACyclicTargetThatWrapsWhereALimitHoldsEndsAtTheCounter) {
  stand_at(kCounterEnd - 100);
  bench_.write(0x607D, 1, -1000);
  bench_.enable(ModeCode::cyclic_synchronous_position);
  for (const std::int64_t target : {kCounterEnd - 40, -kCounterEnd + 20, -kCounterEnd + 80}) {
    const double before = bench_.position();
    bench_.write(0x607A, target);
    bench_.pass(2_ms);
    EXPECT_LE(std::fabs(bench_.position() - before), 60.0) << target;
  }
  EXPECT_EQ(motion().position(), kCounterEnd);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x607A, kCounterEnd - 50);
  bench_.pass(2_ms);
  EXPECT_EQ(motion().position(), kCounterEnd - 50) << "and the way back is free";
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
}

TEST_F(AxisLimits, AVelocityBeyondTheRampGeneratorIsShownAsLimitedAndReached) {
  bench_.set_profile(0, 4'294'967'295, 4'294'967'295);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 8'388'608);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.pass(3_s);
  EXPECT_EQ(bench_.velocity(), 8'388'607.0);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x60FF, 8'388'607);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
}

// Limit switches

TEST_F(AxisLimits, AReleasedLimitSwitchLimitsNothing) {
  bench_.set_profile(0, 200'000, 200'000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 10'000);
  bench_.pass(100_ms);
  bench_.axis->conditions().positive_limit_switch = true;
  bench_.pass(1_ms);
  ASSERT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x60FF, 5000);  // refused while the switch is pressed
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.axis->conditions().positive_limit_switch = false;
  bench_.pass(1_ms);
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 0.0) << "it moves with the next command only";
  bench_.write(0x60FF, 5001);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 5001.0);
}

TEST_F(AxisLimits, ALimitSwitchStopsTheMotorWithinAStepNotAControlPeriod) {
  bench_.right_switch = AxisBench::Cam{.from = 20'000, .to = 1'000'000};
  bench_.set_profile(0, 400'000, 400'000);
  bench_.enable(ModeCode::profile_velocity);
  for (const base::SimDuration phase : {0_us, 350_us, 700_us}) {
    bench_.pass(phase);
    bench_.write(0x60FF, -40'000);
    bench_.pass(500_ms);
    bench_.write(0x60FF, 40'000);
    bench_.pass(2_s);
    EXPECT_EQ(bench_.velocity(), 0.0);
    EXPECT_GE(bench_.shaft(), 20'000);
    EXPECT_LE(bench_.shaft(), 20'004) << "two steps at 40000 pps";
    EXPECT_TRUE(bench_.axis->errors().has(AxisError::positive_limit_switch));
  }
}

TEST_F(AxisLimits, CommandsIntoAPressedSwitchDoNotDisturbTheStopRamp) {
  for (const ModeCode mode : {ModeCode::profile_velocity, ModeCode::cyclic_synchronous_velocity}) {
    AxisBench bench;
    bench.axis->settings().ramp.stop_deceleration = 100'000.0;
    bench.set_profile(0, 200'000, 4'000'000);
    bench.enable(mode);
    bench.write(0x60FF, 10'000);
    bench.pass(500_ms);
    bench.axis->conditions().positive_limit_switch = true;
    for (int i = 0; i < 51; ++i) {
      bench.pass(1_ms);
      bench.write(0x60FF, 10'000 + i % 2);
    }
    EXPECT_NEAR(bench.velocity(), 5000.0, 100.0);
  }
}

}  // namespace
}  // namespace stator::drive
