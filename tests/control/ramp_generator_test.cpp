// Trapezoidal ramps against analytic instants, with targets and limits that change in flight.
#include "stator/control/ramp/ramp_generator.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "control/random_ramps.hpp"

namespace stator::control {
namespace {

using namespace base::literals;
using tests::position_of;

constexpr RampLimits kLimits{
    .velocity = 1'000.0, .acceleration = 10'000.0, .deceleration = 5'000.0};

void run_to_rest(RampGenerator& ramp) {
  for (int tick = 0; tick < 10'000'000 && !ramp.at_rest(); ++tick) {
    ramp.advance(50_us);
  }
}

TEST(RampGenerator, FreshOneStandsAtZero) {
  const RampGenerator ramp;
  EXPECT_TRUE(ramp.at_rest());
  EXPECT_EQ(ramp.position(), (MicrostepPosition{0, 0.0}));
  EXPECT_EQ(ramp.phase(), RampPhase::standstill);
}

TEST(RampGenerator, TrapezoidPassesTheAnalyticInstants) {
  // 0.1 s up (50), 0.85 s cruise (850), 0.2 s down (100).
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  EXPECT_DOUBLE_EQ(ramp.remaining_time(), 1.15);
  ramp.advance(50_ms);
  EXPECT_NEAR(ramp.velocity(), 500.0, 1e-9);
  EXPECT_NEAR(position_of(ramp), 12.5, 1e-9);
  EXPECT_EQ(ramp.phase(), RampPhase::accelerating);
  ramp.advance(450_ms);
  EXPECT_EQ(ramp.velocity(), 1'000.0);
  EXPECT_NEAR(position_of(ramp), 450.0, 1e-9);
  EXPECT_EQ(ramp.phase(), RampPhase::constant_velocity);
  ramp.advance(550_ms);
  EXPECT_NEAR(ramp.velocity(), 500.0, 1e-9);
  EXPECT_NEAR(position_of(ramp), 975.0, 1e-9);
  EXPECT_EQ(ramp.phase(), RampPhase::decelerating);
  ramp.advance(101_ms);
  EXPECT_EQ(ramp.velocity(), 0.0);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'000, 0.0}));
  EXPECT_TRUE(ramp.target_reached());
  EXPECT_EQ(ramp.phase(), RampPhase::standstill);
}

TEST(RampGenerator, ShortMoveIsATriangle) {
  // vp^2 = 2 a d X / (a + d) = 100000
  RampGenerator ramp;
  ramp.move_to(15, kLimits);
  EXPECT_NEAR(ramp.remaining_time(), 316.22776601683796 * (1 / 10'000.0 + 1 / 5'000.0), 1e-12);
  run_to_rest(ramp);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{15, 0.0}));
}

TEST(RampGenerator, TargetBehindTheBrakingPointIsPassedAndReturnedTo) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(500_ms);  // at 450, 1000 pps, braking takes 100
  ramp.move_to(500, kLimits);
  double furthest = 0.0;
  while (!ramp.at_rest()) {
    ramp.advance(50_us);
    furthest = std::max(furthest, position_of(ramp));
  }
  EXPECT_NEAR(furthest, 550.0, 1e-4);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{500, 0.0}));
}

TEST(RampGenerator, LoweredVelocityIsApproachedWithTheDeceleration) {
  RampGenerator ramp;
  ramp.move_to(10'000, kLimits);
  ramp.advance(1_s);
  ramp.set_limits({.velocity = 500.0, .acceleration = 10'000.0, .deceleration = 5'000.0});
  EXPECT_EQ(ramp.phase(), RampPhase::decelerating);
  ramp.advance(50_ms);
  EXPECT_NEAR(ramp.velocity(), 750.0, 1e-9);
  ramp.advance(100_ms);
  EXPECT_EQ(ramp.velocity(), 500.0);
}

TEST(RampGenerator, RaisedDecelerationWhileBrakingArrivesExactly) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(1_s);
  ramp.set_limits({.velocity = 1'000.0, .acceleration = 10'000.0, .deceleration = 50'000.0});
  run_to_rest(ramp);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'000, 0.0}));
}

TEST(RampGenerator, SameCommandAgainWhileBrakingDoesNotDisturbTheArrival) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(1_s);
  const double expected = ramp.remaining_time();
  // Another target in between forces new plans from the middle of braking.
  ramp.move_to(2'000, kLimits);
  ramp.move_to(1'000, kLimits);
  EXPECT_NEAR(ramp.remaining_time(), expected, 1e-9);
  EXPECT_EQ(ramp.phase(), RampPhase::decelerating);
}

TEST(RampGenerator, VelocityModeReversesThroughZeroWithBothRates) {
  RampGenerator ramp;
  ramp.move_at_velocity(1'000.0, kLimits);
  ramp.advance(1_s);
  EXPECT_TRUE(ramp.target_reached());
  ramp.move_at_velocity(-1'000.0, kLimits);
  ramp.advance(100_ms);
  EXPECT_NEAR(ramp.velocity(), 500.0, 1e-9);
  ramp.advance(100_ms);
  EXPECT_NEAR(ramp.velocity(), 0.0, 1e-9);
  ramp.advance(50_ms);
  EXPECT_NEAR(ramp.velocity(), -500.0, 1e-9);
  ramp.advance(50_ms);
  EXPECT_NEAR(ramp.velocity(), -1'000.0, 1e-9);
}

TEST(RampGenerator, VelocityIsCappedByTheLimit) {
  RampGenerator ramp;
  ramp.move_at_velocity(-5'000.0, kLimits);
  ramp.advance(10_s);
  EXPECT_EQ(ramp.velocity(), -1'000.0);
}

TEST(RampGenerator, StopBrakesWithItsOwnDecelerationAndStays) {
  RampGenerator ramp;
  ramp.move_at_velocity(1'000.0, kLimits);
  ramp.advance(1_s);
  const double start = position_of(ramp);
  ramp.stop(2'000.0);
  EXPECT_DOUBLE_EQ(ramp.remaining_time(), 0.5);
  run_to_rest(ramp);
  EXPECT_NEAR(position_of(ramp) - start, 250.0, 1e-9);
  EXPECT_EQ(ramp.velocity(), 0.0);
  ramp.advance(10_s);
  EXPECT_NEAR(position_of(ramp) - start, 250.0, 1e-9);
}

TEST(RampGenerator, HardStopTakesNoTime) {
  RampGenerator ramp;
  ramp.move_at_velocity(1'000.0, kLimits);
  ramp.advance(123_ms);
  const MicrostepPosition here = ramp.position();
  ramp.stop_at_once();
  EXPECT_EQ(ramp.velocity(), 0.0);
  EXPECT_TRUE(ramp.at_rest());
  ramp.advance(1_s);
  EXPECT_EQ(ramp.position(), here);
}

TEST(RampGenerator, AfterAStopTheSameTargetMayBeTakenUpAgain) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(300_ms);
  ramp.stop(100'000.0);
  run_to_rest(ramp);
  ramp.move_to(1'000, kLimits);
  run_to_rest(ramp);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'000, 0.0}));
}

TEST(RampGenerator, WithoutParametersNothingMoves) {
  for (const RampLimits& limits :
       {RampLimits{0.0, 10'000.0, 5'000.0}, RampLimits{1'000.0, 0.0, 5'000.0},
        RampLimits{1'000.0, 10'000.0, 0.0}, RampLimits{-1.0, 10'000.0, 5'000.0},
        RampLimits{std::numeric_limits<double>::quiet_NaN(), 10'000.0, 5'000.0}}) {
    RampGenerator ramp;
    ramp.move_to(1'000, limits);
    ramp.advance(1_s);
    EXPECT_EQ(ramp.position(), (MicrostepPosition{0, 0.0}));
    EXPECT_FALSE(ramp.target_reached());
    ramp.move_at_velocity(500.0, limits);
    ramp.advance(1_s);
    EXPECT_EQ(ramp.position(), (MicrostepPosition{0, 0.0}));
  }
}

TEST(RampGenerator, VelocityLimitOfZeroInFlightBrakesToRest) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(500_ms);
  ramp.set_limits({.velocity = 0.0, .acceleration = 10'000.0, .deceleration = 5'000.0});
  run_to_rest(ramp);
  EXPECT_NEAR(position_of(ramp), 550.0, 1e-9);
  ramp.set_limits(kLimits);
  run_to_rest(ramp);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'000, 0.0}));
}

TEST(RampGenerator, AccelerationOfZeroInFlightStillArrives) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(50_ms);
  ramp.set_limits({.velocity = 1'000.0, .acceleration = 0.0, .deceleration = 5'000.0});
  ramp.advance(1_s);
  EXPECT_NEAR(ramp.velocity(), 500.0, 1e-9);
  run_to_rest(ramp);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'000, 0.0}));
}

TEST(RampGenerator, SetPositionRenamesTheMicrostepAndLeavesTheMotorWhereItIs) {
  RampGenerator ramp;
  ramp.move_to(777, kLimits);
  run_to_rest(ramp);
  ramp.set_position(-20);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{-20, 0.0}));
  EXPECT_EQ(ramp.motor_microsteps(), 777);
  ramp.move_to(0, kLimits);
  run_to_rest(ramp);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{0, 0.0}));
  EXPECT_EQ(ramp.motor_microsteps(), 797);
}

TEST(RampGenerator, CoversTheWholeRangeOfInteger32) {
  RampGenerator ramp;
  ramp.set_position(std::numeric_limits<std::int32_t>::min());
  const RampLimits fast{.velocity = 8e6, .acceleration = 1e7, .deceleration = 1e7};
  ramp.move_to(std::numeric_limits<std::int32_t>::max(), fast);
  EXPECT_NEAR(ramp.remaining_time(), 4294967295.0 / 8e6 + 0.8, 1e-9);
  ramp.advance(base::SimDuration(1'000'000'000) * 600);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{std::numeric_limits<std::int32_t>::max(), 0.0}));
}

TEST(RampGenerator, ADayAtConstantSpeedDoesNotDrift) {
  RampGenerator ramp;
  ramp.move_at_velocity(51'200.5, {.velocity = 1e6, .acceleration = 1e6, .deceleration = 1e6});
  ramp.advance(1_s);
  const MicrostepPosition start = ramp.position();
  for (int second = 0; second < 86'400; ++second) {
    ramp.advance(700_ms);
    ramp.advance(300_ms);
  }
  EXPECT_NEAR(distance(start, ramp.position()), 51'200.5 * 86'400.0, 1e-5);
}

TEST(RampGenerator, RestoredStateContinuesIdentically) {
  RampGenerator ramp;
  ramp.move_to(1'000, kLimits);
  ramp.advance(123'457_ns);
  RampGenerator copy;
  copy.restore(ramp.state());
  for (int tick = 0; tick < 30'000; ++tick) {
    ramp.advance(50_us);
    copy.advance(50_us);
    ASSERT_EQ(copy.position(), ramp.position());
  }
}

}  // namespace
}  // namespace stator::control
