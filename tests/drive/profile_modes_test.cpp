// Profile position and profile velocity of CiA 402: handshake, relative targets, window, halt.
#include "stator/drive/modes/profile_modes.hpp"

#include <gtest/gtest.h>

#include "drive/axis_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

class ProfilePositionMode : public testing::Test {
 protected:
  ProfilePositionMode() {
    bench_.set_profile(10'000, 20'000, 40'000);
    bench_.enable(ModeCode::profile_position);
  }
  void move_to(std::int64_t target, unsigned extra_bits = 0) {
    bench_.write(0x607A, target);
    bench_.write(0x6040, 0x1F | extra_bits);
    bench_.write(0x6040, 0x0F | extra_bits);
  }
  AxisBench bench_;
};

TEST_F(ProfilePositionMode, TravelsOnTheTrapezoidOfTheProfileObjects) {
  // 0.5 s up over 2500, 0.25 s down over 1250, 1 s at 10000 in between.
  move_to(13'750);
  bench_.pass(250_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1);
  EXPECT_NEAR(bench_.position(), 625.0, 0.1);
  bench_.pass(750_ms);
  EXPECT_NEAR(bench_.velocity(), 10'000.0, 0.1);
  EXPECT_NEAR(bench_.position(), 7500.0, 0.1);
  bench_.pass(625_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1);
  bench_.pass(124_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.position(), 13'750.0);
  EXPECT_EQ(bench_.read(0x6064), 13'750);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
}

TEST_F(ProfilePositionMode, TheTrajectoryGeneratorMakesTheDemandOfTheTarget) {
  bench_.write(0x6040, 0);
  bench_.write(0x606A, 0);  // the encoder tells the actual position
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, 13'750);
  EXPECT_EQ(bench_.read(0x6062), 0) << "not the target itself";
  bench_.blocked = true;
  move_to(13'750);
  const auto demanded_after = [](double t) {  // 0.5 s up, 1 s at 10000, 0.25 s down
    if (t < 0.5) {
      return 10'000.0 * t * t;
    }
    if (t < 1.5) {
      return 2'500.0 + 10'000.0 * (t - 0.5);
    }
    return t < 1.75 ? 13'750.0 - 20'000.0 * (1.75 - t) * (1.75 - t) : 13'750.0;
  };
  for (int i = 1; i <= 40; ++i) {
    bench_.pass(50_ms);
    // What the object shows is at most a firmware period of 1 ms old: 10 at full speed.
    EXPECT_NEAR(static_cast<double>(bench_.read(0x6062)), demanded_after(0.05 * i), 12.0) << i;
    EXPECT_EQ(bench_.read(0x6064), 0) << "the shaft is held";
  }
  EXPECT_EQ(bench_.read(0x6062), 13'750);
  EXPECT_EQ(bench_.read(0x607A), 13'750);
}

TEST_F(ProfilePositionMode, OnlyARisingEdgeOfBit4Starts) {
  bench_.write(0x607A, 1000);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.position(), 0.0) << "a target alone moves nothing";
  bench_.write(0x6040, 0x1F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 1000.0);
  bench_.write(0x607A, 2000);
  bench_.write(0x6040, 0x1F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 1000.0) << "the level alone starts nothing";
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6040, 0x1F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 2000.0);
}

TEST_F(ProfilePositionMode, ControlwordAndTargetOfOneFrameActTogether) {
  bench_.place(0x6040, 0x1F);
  bench_.place(0x607A, 777);
  bench_.axis->apply(bench_.now);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 777.0);
}

TEST_F(ProfilePositionMode, SetPointIsAcknowledgedUntilBit4Falls) {
  EXPECT_FALSE(bench_.status(statusword::kSetPointAcknowledge));
  bench_.write(0x607A, 5000);
  bench_.write(0x6040, 0x1F);
  EXPECT_TRUE(bench_.status(statusword::kSetPointAcknowledge));
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.pass(10_ms);
  EXPECT_TRUE(bench_.status(statusword::kSetPointAcknowledge));
  EXPECT_TRUE(bench_.status(statusword::kMotorActivity));
  bench_.write(0x6040, 0x0F);
  EXPECT_FALSE(bench_.status(statusword::kSetPointAcknowledge));
  bench_.pass(2_s);
  EXPECT_EQ(bench_.position(), 5000.0) << "clearing bit 4 does not stop the move";
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
}

TEST_F(ProfilePositionMode, ANewSetPointTakesOverInFlight) {
  move_to(50'000);
  bench_.pass(1_s);
  move_to(-1000);
  bench_.pass(10_s);
  EXPECT_EQ(bench_.position(), -1000.0);
  EXPECT_TRUE(bench_.status(statusword::kNegativeDirection)) << "the last direction";
}

TEST_F(ProfilePositionMode, RelativeTargetsReferToWhat60F2Says) {
  move_to(10'000);
  bench_.pass(500_ms);  // 2500 microsteps on the way
  bench_.write(0x60F2, 0);
  move_to(1000, controlword::kRelative);
  bench_.pass(5_s);
  EXPECT_EQ(bench_.position(), 11'000.0) << "preceding target";

  move_to(0);
  bench_.pass(10_s);
  move_to(10'000);
  bench_.pass(500_ms);
  bench_.write(0x60F2, 1);
  const std::int64_t demand = bench_.axis->motion().position();
  EXPECT_NEAR(static_cast<double>(demand), 2500.0, 1.0);
  move_to(4000, controlword::kRelative);
  bench_.pass(5_s);
  EXPECT_EQ(bench_.position(), static_cast<double>(demand + 4000)) << "position demand";
}

TEST_F(ProfilePositionMode, RelativeToActualUsesTheEncoder) {
  bench_.write(0x6040, 0);
  bench_.write(0x606A, 0);
  bench_.enable(ModeCode::profile_position);
  bench_.blocked = true;
  move_to(5000);
  bench_.pass(2_s);
  ASSERT_EQ(bench_.read(0x6064), 0);
  bench_.write(0x60F2, 2);
  move_to(300, controlword::kRelative);
  bench_.pass(5_s);
  EXPECT_EQ(bench_.position(), 300.0);
}

TEST_F(ProfilePositionMode, NothingMovesWithoutVelocityOrAcceleration) {
  bench_.set_profile(0, 20'000, 40'000);
  move_to(1000);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 0.0);
  bench_.set_profile(10'000, 0, 40'000);
  move_to(1000);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 0.0);
}

TEST_F(ProfilePositionMode, ChangedProfileObjectsActInFlight) {
  move_to(1'000'000);
  bench_.pass(1_s);
  bench_.write(0x6081, 4000);
  bench_.pass(200_ms);
  EXPECT_NEAR(bench_.velocity(), 4000.0, 0.1);
}

TEST_F(ProfilePositionMode, WindowAndTimeDecideAboutTargetReached) {
  bench_.write(0x6040, 0);
  bench_.write(0x606A, 0);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x6067, 100);
  bench_.write(0x6068, 50);
  bench_.blocked = true;
  move_to(1000);
  bench_.pass(2_s);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached)) << "demand is there, the shaft is not";
  bench_.write(0x6067, 1000);
  bench_.pass(49_ms);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached)) << "not long enough in the window";
  bench_.pass(3_ms);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
}

TEST_F(ProfilePositionMode, HaltBrakesOnTheSlowDownRampAndTheMoveGoesOnAfterwards) {
  move_to(100'000);
  bench_.pass(1_s);
  bench_.write(0x6040, 0x010F);
  bench_.pass(125_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1) << "6084h";
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.pass(130_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached)) << "during halt: the axis stands";
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.write(0x6040, 0x000F);
  bench_.pass(20_s);
  EXPECT_EQ(bench_.position(), 100'000.0);
}

TEST_F(ProfilePositionMode, EnablingUnderHaltMovesNothingBeforeASetPoint) {
  move_to(1000);
  bench_.pass(2_s);
  bench_.write(0x6040, 0);
  bench_.write(0x6040, 0x0106);
  bench_.write(0x6040, 0x010F);
  bench_.write(0x6040, 0x000F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 1000.0);
}

TEST_F(ProfilePositionMode, EnablingForgetsAnUnfinishedMove) {
  move_to(10'000);
  bench_.pass(500_ms);
  bench_.write(0x6040, 0);
  bench_.enable(ModeCode::profile_position);
  bench_.pass(1_ms);
  const std::int64_t stopped = bench_.axis->motion().position();
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  move_to(1000, controlword::kRelative);
  bench_.pass(5_s);
  EXPECT_EQ(bench_.position(), static_cast<double>(stopped + 1000));
}

TEST_F(ProfilePositionMode, EdgeInTheFrameThatEnablesIsTaken) {
  bench_.write(0x6040, 0x0007);
  bench_.write(0x607A, 500);
  bench_.write(0x6040, 0x001F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 500.0);
}

class ProfileVelocityMode : public testing::Test {
 protected:
  ProfileVelocityMode() {
    bench_.set_profile(0, 20'000, 40'000);
    bench_.enable(ModeCode::profile_velocity);
  }
  AxisBench bench_;
};

TEST_F(ProfileVelocityMode, AcceleratesAndStopsWithTheProfileObjects) {
  bench_.write(0x60FF, 10'000);
  bench_.pass(250_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1);
  EXPECT_FALSE(bench_.status(statusword::kTargetReached));
  bench_.pass(300_ms);
  EXPECT_EQ(bench_.read(0x606C), 10'000);
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
  EXPECT_FALSE(bench_.status(statusword::kSetPointAcknowledge));
  bench_.write(0x60FF, 0);
  bench_.pass(125_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1);
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_FALSE(bench_.status(statusword::kMotorActivity));
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(ProfileVelocityMode, TheSignGivesTheDirection) {
  bench_.write(0x60FF, -10'000);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.read(0x606C), -10'000);
  EXPECT_TRUE(bench_.status(statusword::kNegativeDirection));
  bench_.write(0x60FF, 10'000);
  bench_.pass(2_s);
  EXPECT_EQ(bench_.read(0x606C), 10'000);
  EXPECT_FALSE(bench_.status(statusword::kNegativeDirection));
}

TEST_F(ProfileVelocityMode, StopsExactlyAtASoftwareLimitAndMayMoveBack) {
  bench_.write(0x607D, 2, 20'000);
  bench_.write(0x60FF, 10'000);
  bench_.pass(10_s);
  EXPECT_EQ(bench_.position(), 20'000.0);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x60FF, 5000);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 20'000.0);
  bench_.write(0x60FF, -5000);
  bench_.pass(1_s);
  EXPECT_LT(bench_.position(), 20'000.0);
  EXPECT_FALSE(bench_.status(statusword::kInternalLimit));
}

TEST_F(ProfileVelocityMode, EnablingUnderHaltWaitsForItsEnd) {
  bench_.write(0x6040, 0x0106);
  bench_.write(0x60FF, 10'000);
  bench_.write(0x6040, 0x010F);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  bench_.write(0x6040, 0x000F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 10'000.0);
}

TEST_F(ProfileVelocityMode, HaltStopsAndItsEndResumes) {
  bench_.write(0x60FF, 10'000);
  bench_.pass(1_s);
  bench_.write(0x6040, 0x010F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 0.0);
  bench_.write(0x60FF, 8000);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.velocity(), 0.0) << "targets wait for the end of halt";
  bench_.write(0x6040, 0x000F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 8000.0);
}

}  // namespace
}  // namespace stator::drive
