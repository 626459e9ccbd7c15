// Interpolation of cyclic positions and velocities over a period, and stops that begin within one.
#include <gtest/gtest.h>

#include "stator/control/ramp/interpolation_profile.hpp"
#include "stator/control/ramp/ramp_generator.hpp"

namespace stator::control {
namespace {

using namespace base::literals;

TEST(PositionInterpolation, ReachesTheTargetAfterThePeriodAndThenHoldsIt) {
  RampGenerator generator;
  generator.follow_position(100, 1_ms);
  generator.advance(500_us);
  EXPECT_NEAR(distance({0, 0.0}, generator.position()), 50.0, 1e-9);
  EXPECT_DOUBLE_EQ(generator.velocity(), 100'000.0);
  generator.advance(500_us);
  EXPECT_EQ(generator.position(), (MicrostepPosition{100, 0.0}));
  generator.advance(5_ms);
  EXPECT_EQ(generator.position(), (MicrostepPosition{100, 0.0}));
  EXPECT_EQ(generator.velocity(), 0.0);
  EXPECT_TRUE(generator.at_rest());
}

TEST(PositionInterpolation, TargetsInTimeGiveAnUnbrokenVelocity) {
  RampGenerator generator;
  for (int cycle = 1; cycle <= 100; ++cycle) {
    generator.follow_position(25 * cycle, 1_ms);
    for (int tick = 0; tick < 20; ++tick) {
      generator.advance(50_us);
      ASSERT_DOUBLE_EQ(generator.velocity(), 25'000.0);
    }
    ASSERT_EQ(generator.position(), (MicrostepPosition{25 * cycle, 0.0}));
  }
}

TEST(PositionInterpolation, ATargetGivenTwiceIsStoodAt) {
  RampGenerator generator;
  generator.follow_position(10, 1_ms);
  generator.advance(1_ms);
  generator.follow_position(10, 1_ms);
  EXPECT_EQ(generator.velocity(), 0.0);
  EXPECT_TRUE(generator.target_reached());
}

TEST(PositionInterpolation, APeriodOfZeroJumps) {
  RampGenerator generator;
  generator.follow_position(10, 0_ms);
  EXPECT_EQ(generator.position(), (MicrostepPosition{10, 0.0}));
}

TEST(VelocityInterpolation, ReachesTheVelocityAfterThePeriodAndThenHoldsIt) {
  RampGenerator generator;
  generator.follow_velocity(1'000.0, 2_ms);
  generator.advance(1_ms);
  EXPECT_DOUBLE_EQ(generator.velocity(), 500.0);
  EXPECT_NEAR(distance({0, 0.0}, generator.position()), 0.25, 1e-12);
  generator.advance(1_ms);
  EXPECT_DOUBLE_EQ(generator.velocity(), 1'000.0);
  generator.advance(1_s);
  EXPECT_DOUBLE_EQ(generator.velocity(), 1'000.0);
  EXPECT_NEAR(distance({0, 0.0}, generator.position()), 1'001.0, 1e-9);
}

TEST(VelocityInterpolation, CanBeBrakedByARampAfterwards) {
  RampGenerator generator;
  generator.follow_velocity(-1'000.0, 1_ms);
  generator.advance(1_s);
  generator.stop(10'000.0);
  generator.advance(99_ms);
  EXPECT_LT(generator.velocity(), 0.0);
  generator.advance(1_ms);
  EXPECT_EQ(generator.velocity(), 0.0);
}

TEST(PositionInterpolation, AStopBeginsWithWhatTheGeneratorCanHold) {
  for (const bool s_shaped : {false, true}) {
    RampGenerator generator;
    generator.set_maximum_velocity(8e6);
    generator.follow_position(-1'024'000, 10_ms);
    generator.advance(5_ms);
    EXPECT_DOUBLE_EQ(generator.velocity(), -102.4e6) << "the target is the master's";
    RampLimits limits{.deceleration = 2e6};
    limits.shape = s_shaped ? RampShape::s_shaped : RampShape::six_point;
    EXPECT_DOUBLE_EQ(generator.braking_distance(limits), 0.5 * 8e6 * 8e6 / 2e6);
    if (s_shaped) {
      generator.stop(limits);
    } else {
      generator.stop(2e6);
    }
    EXPECT_DOUBLE_EQ(generator.velocity(), -8e6);
    EXPECT_NEAR(generator.remaining_time(), 4.0, 1e-9);
    generator.advance(4'001_ms);
    EXPECT_TRUE(generator.at_rest());
    EXPECT_NEAR(distance({-512'000, 0.0}, generator.position()), -16e6, 1.0);
  }
}

TEST(PositionInterpolation, BelowTheBoundAStopBeginsWithTheVelocityThereIs) {
  RampGenerator bounded;
  RampGenerator free;
  bounded.set_maximum_velocity(8e6);
  for (RampGenerator* generator : {&bounded, &free}) {
    generator->follow_position(7'777, 1_ms);
    generator->advance(300_us);
    generator->stop(123'456.0);
    generator->advance(5_s);
  }
  EXPECT_EQ(bounded.velocity(), free.velocity());
  EXPECT_EQ(bounded.position(), free.position()) << "to the last bit";
}

TEST(PositionInterpolation, ASingleMicrostepTakesThePeriodToo) {
  RampGenerator generator;
  generator.follow_position(1, 1_ms);
  EXPECT_EQ(generator.phase(), RampPhase::constant_velocity);
  generator.advance(500_us);
  EXPECT_NEAR(distance({0, 0.0}, generator.position()), 0.5, 1e-12);
}

TEST(PositionInterpolation, TheShortestPeriodIsNoJump) {
  const MotionPlan plan = plan_position_interpolation({}, 10, base::SimDuration(1));
  EXPECT_DOUBLE_EQ(plan.duration(), 1e-9);
}

TEST(PositionInterpolation, ATargetWhereTheMotorStandsIsStandstill) {
  // The phase chooses the current: a motor that is not to move gets standby current.
  const MotionPlan plan = plan_position_interpolation({{10, 0.0}, 0.0, 0.0}, 10, 1_ms);
  ASSERT_EQ(plan.size(), 1U);
  EXPECT_EQ(plan[0].phase, RampPhase::standstill);
}

TEST(VelocityInterpolation, AChangeByOneTakesThePeriodToo) {
  RampGenerator generator;
  generator.follow_velocity(1.0, 2_ms);
  generator.advance(1_ms);
  EXPECT_DOUBLE_EQ(generator.velocity(), 0.5);
}

TEST(VelocityInterpolation, TheShortestPeriodIsNoJump) {
  const MotionPlan plan = plan_velocity_interpolation({}, 10.0, base::SimDuration(1));
  EXPECT_DOUBLE_EQ(plan.duration(), 1e-9);
}

TEST(VelocityInterpolation, TheVelocityThereIsIsKeptAtOnce) {
  const MotionPlan plan = plan_velocity_interpolation({{}, 500.0, 0.0}, 500.0, 1_ms);
  ASSERT_EQ(plan.size(), 1U);
  EXPECT_EQ(plan[0].phase, RampPhase::constant_velocity);
}

TEST(VelocityInterpolation, GainingSpeedIsAcceleratingInBothDirections) {
  const auto phase = [](double from, double to) {
    return plan_velocity_interpolation({{}, from, 0.0}, to, 1_ms)[0].phase;
  };
  EXPECT_EQ(phase(0.0, 100.0), RampPhase::accelerating);
  EXPECT_EQ(phase(-100.0, -200.0), RampPhase::accelerating);
  EXPECT_EQ(phase(200.0, 100.0), RampPhase::decelerating);
  EXPECT_EQ(phase(-200.0, 0.0), RampPhase::decelerating);
}

}  // namespace
}  // namespace stator::control
