// S-shaped ramps against analytic instants, and properties of a hundred thousand random targets.
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "control/ramp_audit.hpp"
#include "control/random_ramps.hpp"
#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/control/ramp/ramp_profile.hpp"

namespace stator::control {
namespace {

using namespace base::literals;
using tests::BowAudit;
using tests::check_mirrored_traces;
using tests::check_traces_of_any_tick;
using tests::decades;
using tests::position_of;
using tests::random_target;
using tests::Start;

constexpr RampLimits kBows{.velocity = 1'000.0,
                           .acceleration = 5'000.0,
                           .deceleration = 10'000.0,
                           .shape = RampShape::s_shaped,
                           .jerk = {100'000.0, 50'000.0, 200'000.0, 400'000.0}};

RampLimits random_bows(base::Random& random) {
  RampLimits limits{.velocity = decades(random, 1e2, 1e6),
                    .acceleration = decades(random, 1e3, 1e7),
                    .deceleration = decades(random, 1e3, 1e7),
                    .shape = RampShape::s_shaped};
  for (double& jerk : limits.jerk) {
    jerk = decades(random, 1e3, 1e9);
  }
  return limits;
}

TEST(SShapedRamp, PassesTheInstantsOfItsFourBows) {
  // Up: 0.05 s bow 1 (125 pps), 0.125 s at 5000 (625), 0.1 s bow 2 (250).
  // Down: 0.05 s bow 3 (250), 0.0625 s at 10000 (625), 0.025 s bow 4 (125).
  RampGenerator ramp;
  ramp.move_to(10'000, kBows);
  const auto after = [&ramp](base::SimDuration duration) {
    ramp.advance(duration);
    return std::array{ramp.velocity(), ramp.acceleration()};
  };
  EXPECT_NEAR(after(25_ms)[1], 2'500.0, 1e-6);
  EXPECT_NEAR(after(25_ms)[0], 125.0, 1e-9);
  EXPECT_NEAR(position_of(ramp), 100'000.0 * 0.05 * 0.05 * 0.05 / 6.0, 1e-9);
  EXPECT_EQ(ramp.phase(), RampPhase::accelerating);
  EXPECT_NEAR(after(125_ms)[0], 750.0, 1e-9);
  EXPECT_NEAR(ramp.acceleration(), 5'000.0, 1e-9);
  EXPECT_NEAR(after(50_ms)[1], 2'500.0, 1e-6);
  EXPECT_EQ(after(60_ms)[0], 1'000.0);
  EXPECT_EQ(ramp.acceleration(), 0.0);
  EXPECT_EQ(ramp.phase(), RampPhase::constant_velocity);
  const double braking = 0.05 + 0.0625 + 0.025;
  ramp.advance(base::SimDuration(std::llround((ramp.remaining_time() - braking) * 1e9)));
  EXPECT_NEAR(after(25_ms)[1], -5'000.0, 0.1);
  EXPECT_NEAR(after(25_ms)[0], 750.0, 1e-3);
  EXPECT_NEAR(after(62'500_us)[0], 125.0, 1e-3);
  EXPECT_NEAR(ramp.acceleration(), -10'000.0, 0.5);
  EXPECT_FALSE(ramp.target_reached());
  after(26_ms);
  EXPECT_TRUE(ramp.target_reached());
  EXPECT_EQ(ramp.position(), (MicrostepPosition{10'000, 0.0}));
}

TEST(SShapedRamp, WithoutJerkACornerIsATrapezoids) {
  RampLimits corners = kBows;
  corners.jerk = {};
  RampLimits linear = kBows;
  linear.shape = RampShape::six_point;
  for (const std::int64_t target : {std::int64_t{20}, std::int64_t{10'000}}) {
    RampGenerator bows;
    RampGenerator trapezoid;
    bows.move_to(target, corners);
    trapezoid.move_to(target, linear);
    EXPECT_NEAR(bows.remaining_time(), trapezoid.remaining_time(), 1e-9);
    for (int tick = 0; tick < 200; ++tick) {
      bows.advance(1_ms);
      trapezoid.advance(1_ms);
      ASSERT_NEAR(bows.velocity(), trapezoid.velocity(), 1e-3) << tick;
    }
  }
}

TEST(SShapedRamp, BrakingDistanceIsTheWayOfTheStop) {
  base::Random random(41);
  for (int i = 0; i < 2'000; ++i) {
    const RampLimits limits = random_bows(random);
    RampGenerator ramp;
    ramp.move_at_velocity(decades(random, 1.0, 1e6), limits);
    ramp.advance(base::SimDuration(static_cast<std::int64_t>(decades(random, 1e3, 1e9))));
    const MotionState start = ramp.state().now;
    ramp.stop(limits);
    const double seconds = ramp.remaining_time();
    // Simpson's rule is exact for the velocity of a segment, a parabola.
    double way = 0.0;
    const MotionPlan& plan = ramp.state().plan;
    for (std::size_t k = 0; k + 1 < plan.size(); ++k) {
      const double length = plan[k].duration;
      way += length / 6.0 *
             (plan[k].at(0.0).velocity + 4.0 * plan[k].at(0.5 * length).velocity +
              plan[k].at(length).velocity);
    }
    const double distance_told = braking_distance(start, limits);
    ASSERT_NEAR(way, distance_told, 1e-9 * distance_told + 1e-7) << "case " << i;
    ramp.advance(base::SimDuration(std::llround(seconds * 1e9) + 2));
    ASSERT_TRUE(ramp.at_rest());
    ASSERT_NEAR(distance(start.position, ramp.position()), distance_told,
                1e-7 + 1e-9 * distance_told);
  }
}

TEST(SShapedRamp, StopsBeforeItReturnsToATargetTooNear) {
  RampGenerator ramp;
  ramp.move_to(100'000, kBows);
  ramp.advance(1_s);
  const double braking = braking_distance(ramp.state().now, kBows);
  const double here = position_of(ramp);
  const auto target = static_cast<std::int64_t>(here + 0.5 * braking);
  ramp.move_to(target, kBows);
  double furthest = here;
  while (!ramp.at_rest()) {
    ramp.advance(50_us);
    furthest = std::max(furthest, position_of(ramp));
  }
  EXPECT_NEAR(furthest, here + braking, 1e-3);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{target, 0.0}));
}

TEST(SShapedRamp, ATargetALittleFurtherWhileBrakingEasesTheBraking) {
  RampGenerator ramp;
  ramp.move_to(1'000, kBows);
  while (ramp.velocity() < 999.0) {
    ramp.advance(1_ms);
  }
  while (ramp.velocity() > 500.0) {
    ramp.advance(1_ms);
  }
  const double before = ramp.remaining_time();
  ramp.move_to(1'001, kBows);
  EXPECT_LT(ramp.acceleration(), -9'000.0) << "the jerk stays limited";
  EXPECT_LT(ramp.remaining_time(), before + 0.02) << "no stop and start for one microstep";
  while (!ramp.at_rest()) {
    const double velocity = ramp.velocity();
    ramp.advance(50_us);
    ASSERT_LE(ramp.velocity(), velocity + 1e-9);
  }
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'001, 0.0}));
}

TEST(SShapedRamp, ALoweredVelocityIsApproachedWithTheDeceleration) {
  RampGenerator ramp;
  ramp.move_to(100'000, kBows);
  ramp.advance(1_s);
  RampLimits slower = kBows;
  slower.velocity = 400.0;
  ramp.set_limits(slower);
  EXPECT_EQ(ramp.phase(), RampPhase::decelerating);
  // 600 pps: 0.05 s bow 3 (250), 0.0225 s held (225), 0.025 s bow 4 (125)
  ramp.advance(97'600_us);
  EXPECT_EQ(ramp.velocity(), 400.0);
  EXPECT_EQ(ramp.acceleration(), 0.0);
}

TEST(SShapedRamp, VelocityModeReversesThroughAStop) {
  RampGenerator ramp;
  ramp.move_at_velocity(1'000.0, kBows);
  ramp.advance(1_s);
  EXPECT_TRUE(ramp.target_reached());
  const Start start(ramp);
  ramp.move_at_velocity(-300.0, kBows);
  BowAudit(start, ramp.state().plan, kBows).check();
  ramp.advance(137'500_us);
  EXPECT_NEAR(ramp.velocity(), 0.0, 1e-6);
  EXPECT_NEAR(ramp.acceleration(), 0.0, 1e-3);
  ramp.advance(1_s);
  EXPECT_EQ(ramp.velocity(), -300.0);
  EXPECT_TRUE(ramp.target_reached());
}

TEST(SShapedRamp, WithoutVelocityAccelerationOrDecelerationNothingMoves) {
  for (double RampLimits::*limit :
       {&RampLimits::velocity, &RampLimits::acceleration, &RampLimits::deceleration}) {
    RampLimits limits = kBows;
    limits.*limit = 0.0;
    RampGenerator ramp;
    ramp.move_to(1'000, limits);
    ramp.advance(1_s);
    EXPECT_EQ(ramp.position(), (MicrostepPosition{0, 0.0}));
    ramp.move_at_velocity(-1'000.0, limits);
    ramp.advance(1_s);
    EXPECT_EQ(ramp.position(), (MicrostepPosition{0, 0.0}));
  }
}

TEST(SShapedRamp, ALongMoveReachesEveryLimitExactly) {
  RampGenerator ramp;
  ramp.move_to(10'000, kBows);
  const MotionPlan& plan = ramp.state().plan;
  ASSERT_EQ(plan.size(), 8U);
  EXPECT_EQ(plan[1].acceleration, 5'000.0);
  EXPECT_EQ(plan[3].reference_velocity, 1'000.0);
  EXPECT_EQ(plan[5].acceleration, -10'000.0);
  EXPECT_EQ(plan[0].jerk, 100'000.0);
  EXPECT_EQ(plan[2].jerk, -50'000.0);
  EXPECT_EQ(plan[4].jerk, -200'000.0);
  EXPECT_EQ(plan[6].jerk, 400'000.0);
}

/// 100,000 targets, most of them in flight, between changes of limits, velocities and stops.
TEST(SShapedRampProperties, NoPlanBreaksALimitAndEveryTargetIsReachedExactly) {
  base::Random random(42);
  RampGenerator ramp;
  RampLimits limits = random_bows(random);
  for (int i = 0; i < 100'000; ++i) {
    SCOPED_TRACE(i);
    Start start(ramp);
    bool planned = true;
    switch (random.below(8)) {
      case 0:
        limits = random_bows(random);
        planned = ramp.mode() != RampMode::stop;
        ramp.set_limits(limits);
        break;
      case 1:
        ramp.move_at_velocity((random.uniform() - 0.5) * 2.0 * limits.velocity, limits);
        break;
      case 2:
        ramp.stop(limits);
        break;
      default:
        planned = false;
        break;
    }
    if (planned) {
      BowAudit(start, ramp.state().plan, limits).check();
      ramp.advance(base::SimDuration(static_cast<std::int64_t>(decades(random, 1e3, 1e8))));
      start = Start(ramp);
    }
    const std::int64_t target =
        ramp.position().microsteps +
        (random.below(4) == 0 ? random_target(random) / 1000 : random_target(random));
    planned = ramp.mode() != RampMode::position || ramp.target_position() != target ||
              ramp.limits() != limits;
    ramp.move_to(target, limits);
    if (planned) {
      BowAudit(start, ramp.state().plan, limits).check();
    }
    if (HasFatalFailure()) {
      return;
    }
    RampGenerator arrived;
    arrived.restore(ramp.state());
    arrived.advance(base::SimDuration(std::llround(ramp.remaining_time() * (1e9 + 1)) + 2));
    ASSERT_EQ(arrived.position(), (MicrostepPosition{target, 0.0}));
    ASSERT_EQ(arrived.velocity(), 0.0);
    ASSERT_EQ(arrived.acceleration(), 0.0);
    ASSERT_TRUE(arrived.target_reached());
    // Mostly into the flight, sometimes to its end.
    const double share = random.below(10) == 0 ? 1.0 : random.uniform();
    ramp.advance(base::SimDuration(std::llround(share * ramp.remaining_time() * 1e9)));
  }
}

TEST(SShapedRampProperties, MirroredCommandsGiveTheMirroredTrace) {
  base::Random random(43);
  check_mirrored_traces(random, 2'000, random_bows, {.position = 1e-7, .velocity = 1e-4});
}

TEST(SShapedRampProperties, TheTraceDoesNotDependOnTheTick) {
  base::Random random(44);
  check_traces_of_any_tick(random, random_bows, {.position = 1e-8, .velocity = 1e-8});
}

TEST(SShapedRampProperties, AChangeOfShapeInFlightArrivesExactly) {
  base::Random random(45);
  for (int i = 0; i < 20'000; ++i) {
    RampGenerator ramp;
    RampLimits limits = random_bows(random);
    const std::int64_t target = random_target(random);
    limits.shape = RampShape::six_point;
    ramp.move_to(target, limits);
    for (int change = 0; change < 3; ++change) {
      ramp.advance(base::SimDuration(std::llround(random.uniform() * ramp.remaining_time() * 1e9)));
      const Start start(ramp);
      limits.shape =
          limits.shape == RampShape::six_point ? RampShape::s_shaped : RampShape::six_point;
      ramp.set_limits(limits);
      if (limits.shape == RampShape::s_shaped) {
        BowAudit(start, ramp.state().plan, limits).check();
        ASSERT_FALSE(HasFatalFailure()) << i;
      }
    }
    ramp.advance(base::SimDuration(std::llround(ramp.remaining_time() * 1e9) + 2));
    ASSERT_EQ(ramp.position(), (MicrostepPosition{target, 0.0})) << i;
  }
}

}  // namespace
}  // namespace stator::control
