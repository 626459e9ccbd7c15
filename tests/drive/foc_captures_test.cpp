// Switches, homing and touch probes of the axis on the FOC block, with a motor that turns.

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using control::foc::field;

class FocSwitches : public testing::Test {
 protected:
  FocBench bench_;
};

TEST_F(FocSwitches, RightLimitStopsForwardMotionAndLetsTheMotorBack) {
  bench_.right_switch = 3.0;
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 1000);
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.rpm(), 0.0, 3.0);
  // 1000 rpm and 10000 rpm/s: 0.83 turns, and what the velocity loop lags behind.
  EXPECT_NEAR(bench_.revolutions(), 3.0 + 0.83, 0.25);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_TRUE(bench_.axis->switches().positive_limit);
  EXPECT_TRUE(bench_.told("positive limit switch"));
  bench_.write(0x60FF, 500);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.rpm(), 0.0, 3.0) << "no further";
  bench_.write(0x60FF, -500);
  bench_.pass(500_ms);
  EXPECT_NEAR(bench_.rpm(), -500.0, 5.0);
  EXPECT_FALSE(bench_.axis->switches().positive_limit);
}

TEST_F(FocSwitches, LeftLimitStopsAPositioningBackwards) {
  bench_.left_switch = -2.0;
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, -20 * FocBench::kTurn);
  bench_.start();
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.rpm(), 0.0, 3.0);
  EXPECT_NEAR(bench_.revolutions(), -2.83, 0.35);
  EXPECT_TRUE(bench_.axis->switches().negative_limit);
}

TEST_F(FocSwitches, ActiveHighSwitchesCanBeConfigured) {
  bench_.axis->settings().reference.switches.right.inverted = false;
  bench_.right_switch = -1.0;  // low all the way: not pressed
  bench_.enable(ModeCode::profile_velocity);
  EXPECT_FALSE(bench_.axis->switches().positive_limit);
  bench_.write(0x60FF, 500);
  bench_.pass(300_ms);
  EXPECT_NEAR(bench_.rpm(), 500.0, 5.0);
}

TEST_F(FocSwitches, WithReversedPositionsTheRightSwitchIsTheNegativeLimit) {
  bench_.axis->foc_settings().polarity = 0xC0;
  bench_.right_switch = 2.0;
  bench_.pass(1_ms);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, -1000);  // forward
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.rpm(), 0.0, 3.0);
  EXPECT_GT(bench_.revolutions(), 2.0);
  EXPECT_TRUE(bench_.axis->switches().negative_limit);
}

TEST_F(FocSwitches, SoftwareLimitsStopAVelocityOnTheLimit) {
  bench_.write(0x607D, 1, -65536);
  bench_.write(0x607D, 2, 4 * FocBench::kTurn);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 1000);
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.revolutions(), 4.0, 0.15);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
}

class FocHoming : public testing::Test {
 protected:
  /// Runs `method` and returns whether home was found.
  bool home(int method) {
    bench_.write(0x6098, method);
    bench_.enable(ModeCode::homing);
    bench_.write(0x6040, 0x1F);
    return bench_.pass_until([&] { return bench_.status(statusword::kHomeAttained); }, 20_s);
  }
  FocBench bench_;
};

TEST_F(FocHoming, OnTheLeftSwitchFindsItsEdgeToTheCount) {
  bench_.left_switch = -1.5;
  ASSERT_TRUE(home(17));
  bench_.pass(300_ms);
  // Captured in the period of the edge, so to the count of the encoder.
  EXPECT_NEAR(static_cast<double>(bench_.position()), (bench_.revolutions() + 1.5) * 65536.0, 33.0);
  EXPECT_NEAR(bench_.revolutions(), -1.5, 0.003);
}

TEST_F(FocHoming, OnTheRightSwitchAndTheIndexBehindIt) {
  bench_.right_switch = 1.4;
  ASSERT_TRUE(home(2));
  bench_.pass(300_ms);
  EXPECT_NEAR(bench_.revolutions(), 1.0, 0.003);
  EXPECT_NEAR(static_cast<double>(bench_.position()), (bench_.revolutions() - 1.0) * 65536.0, 33.0);
}

TEST_F(FocHoming, OnTheIndexAloneInBothDirections) {
  for (const int method : {33, 34}) {
    FocBench bench([] {
      plant::PwmAxisParameters parameters = foc_plant();
      parameters.initial_revolutions = 0.3;
      return parameters;
    }());
    bench.write(0x6098, method);
    bench.enable(ModeCode::homing);
    bench.write(0x6040, 0x1F);
    ASSERT_TRUE(bench.pass_until([&] { return bench.status(statusword::kHomeAttained); }, 20_s));
    bench.pass(300_ms);
    const double home = method == 33 ? 0.0 : 1.0;
    EXPECT_NEAR(bench.revolutions(), home, 0.003) << method;
    EXPECT_NEAR(static_cast<double>(bench.position()), (bench.revolutions() - home) * 65536.0, 33.0)
        << method;
  }
}

TEST_F(FocHoming, OnTheHomeSwitch) {
  bench_.home_switch = {0.8, 1.3};
  ASSERT_TRUE(home(19));
  bench_.pass(300_ms);
  EXPECT_NEAR(std::fabs(bench_.revolutions() - 0.8), 0.0, 0.003);
}

TEST_F(FocHoming, WithReversedPositionsTheLeftSwitchOfThePositionsIsFound) {
  bench_.axis->foc_settings().polarity = 0xC0;
  bench_.right_switch = 1.5;  // where positions fall to
  bench_.pass(1_ms);
  ASSERT_TRUE(home(17));
  bench_.pass(300_ms);
  EXPECT_NEAR(bench_.revolutions(), 1.5, 0.003);
}

TEST_F(FocHoming, OnAHardStopByTheCurrentAgainstIt) {
  FocBench bench([] {
    plant::PwmAxisParameters parameters = foc_plant();
    parameters.load.end_stop_minimum = -1.5;
    return parameters;
  }());
  bench.axis->settings().hard_stop = {
      .current = 0.6, .positive_clearance = 16'384, .negative_clearance = 16'384};
  bench.write(0x6099, 2, 60);
  bench.write(0x6098, -2);
  bench.enable(ModeCode::homing);
  bench.write(0x6040, 0x1F);
  ASSERT_TRUE(bench.pass_until([&] { return bench.status(statusword::kHomeAttained); }, 20_s));
  bench.pass(300_ms);
  EXPECT_NEAR(bench.revolutions(), -1.25, 0.02) << "a quarter turn back from the stop";
  EXPECT_NEAR(static_cast<double>(bench.position()), 0.0, 200.0);
}

TEST_F(FocHoming, OfThePresentPositionNeedsNoMotion) {
  bench_.plant.set_external_torque(0.002);
  bench_.pass(200_ms);
  bench_.plant.set_external_torque(0.0);
  bench_.pass(300_ms);
  ASSERT_NE(bench_.position(), 0);
  ASSERT_TRUE(home(35));
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 64.0);
}

class FocTouchProbe : public testing::Test {
 protected:
  void turn() {
    bench_.enable(ModeCode::profile_velocity);
    bench_.write(0x60FF, 600);
    bench_.pass(300_ms);
  }
  FocBench bench_;
};

TEST_F(FocTouchProbe, HoldsThePositionOfAnEdgeToThePwmPeriod) {
  turn();
  bench_.write(0x60B8, 0x2111);
  bench_.pass(1_ms);
  bench_.probe[1] = true;
  bench_.pass(275_us);
  const double at = bench_.revolutions() * 65536.0;
  bench_.probe[0] = true;
  bench_.step();
  const base::SimTime then = bench_.now;
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x60B9), 0x0103);
  // One period at 600 rpm is 16 units, as is a count of the encoder.
  EXPECT_NEAR(static_cast<double>(bench_.read(0x60BA)), at, 33.0);
  EXPECT_EQ(bench_.read(0x60D1), then.nanoseconds());
  bench_.probe[1] = false;
  bench_.step();
  const base::SimTime later = bench_.now;
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x60B9), 0x0503);
  EXPECT_EQ(bench_.read(0x60D4), later.nanoseconds());
  EXPECT_GT(bench_.read(0x60BD), bench_.read(0x60BA));
}

TEST_F(FocTouchProbe, HoldsIndexPulsesToTheCount) {
  turn();
  bench_.write(0x60B8, 0x0017);  // every index pulse
  std::int64_t last = -1;
  for (int k = 0; k < 5; ++k) {
    const std::int64_t before = bench_.read(0x60B9);
    ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x60B9) != before; }, 150_ms)) << k;
    if (k == 0) {
      ASSERT_TRUE(bench_.pass_until([&] { return (bench_.read(0x60B9) & 2) != 0; }, 150_ms));
    }
    EXPECT_EQ(bench_.read(0x60BA) % 65536, 0) << "N lies at whole turns";
    EXPECT_GT(bench_.read(0x60BA), last);
    last = bench_.read(0x60BA);
  }
}

TEST_F(FocTouchProbe, AnIndexPulseOfBeforeDoesNotCount) {
  turn();
  EXPECT_EQ(bench_.get(field("ENC_N")), 1);
  const std::int64_t turns = bench_.position() / 65536;
  bench_.write(0x60B8, 0x0015);
  ASSERT_TRUE(bench_.pass_until([&] { return (bench_.read(0x60B9) & 2) != 0; }, 150_ms));
  EXPECT_EQ(bench_.read(0x60BA), (turns + 1) * FocBench::kTurn);
}

}  // namespace
}  // namespace stator::drive
