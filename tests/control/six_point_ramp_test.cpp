#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "control/random_ramps.hpp"
#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/control/ramp/ramp_profile.hpp"

namespace stator::control {
namespace {

using namespace base::literals;
using tests::decades;
using tests::position_of;
using tests::random_target;

// From 100 pps with 1000 to 500 (0.4 s, 120), with 5000 to 1000 (0.1 s, 75); down with 10000 to 500
// (0.05 s, 37.5), with 2000 to 200 (0.15 s, 52.5).
constexpr RampLimits kSixPoints{.velocity = 1'000.0,
                                .acceleration = 5'000.0,
                                .deceleration = 10'000.0,
                                .start_velocity = 100.0,
                                .start_acceleration = 1'000.0,
                                .break_velocity = 500.0,
                                .final_deceleration = 2'000.0,
                                .end_velocity = 200.0};

TEST(SixPointRamp, PassesItsSixPoints) {
  RampGenerator ramp;
  ramp.move_to(1'285, kSixPoints);
  EXPECT_EQ(ramp.velocity(), 100.0) << "a step to the start velocity";
  ramp.advance(200_ms);
  EXPECT_NEAR(ramp.velocity(), 300.0, 1e-9) << "A1";
  ramp.advance(200_ms);
  EXPECT_NEAR(ramp.velocity(), 500.0, 1e-9);
  EXPECT_NEAR(position_of(ramp), 120.0, 1e-9);
  ramp.advance(50_ms);
  EXPECT_NEAR(ramp.velocity(), 750.0, 1e-9) << "acceleration above V1";
  ramp.advance(500_ms);
  EXPECT_EQ(ramp.velocity(), 1'000.0);
  EXPECT_EQ(ramp.phase(), RampPhase::constant_velocity);
  ramp.advance(550_ms);  // at 1.5 s, when braking begins
  EXPECT_NEAR(position_of(ramp), 1'195.0, 1e-9);
  ramp.advance(25_ms);
  EXPECT_NEAR(ramp.velocity(), 750.0, 1e-9) << "deceleration above V1";
  ramp.advance(100_ms);
  EXPECT_NEAR(ramp.velocity(), 350.0, 1e-9) << "D1";
  ramp.advance(74'999_us);
  EXPECT_NEAR(ramp.velocity(), 200.0, 0.01) << "the end velocity on the target";
  EXPECT_FALSE(ramp.target_reached());
  ramp.advance(2_us);
  EXPECT_EQ(ramp.velocity(), 0.0);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'285, 0.0}));
  EXPECT_TRUE(ramp.target_reached());
}

TEST(SixPointRamp, AStopDecelerationLeadsFromTheEndVelocityToRestOnTheTarget) {
  RampLimits limits = kSixPoints;
  limits.stop_deceleration = 4'000.0;  // 0.05 s, 5 microsteps
  RampGenerator ramp;
  ramp.move_to(1'290, limits);
  ramp.advance(1'700_ms);
  EXPECT_NEAR(ramp.velocity(), 200.0, 1e-9);
  EXPECT_NEAR(position_of(ramp), 1'285.0, 1e-9);
  ramp.advance(25_ms);
  EXPECT_NEAR(ramp.velocity(), 100.0, 1e-9);
  ramp.advance(26_ms);
  EXPECT_EQ(ramp.velocity(), 0.0);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1'290, 0.0}));
}

TEST(SixPointRamp, AMoveTooShortForTheEndVelocityEndsWithTheSpeedItHas) {
  RampLimits limits = kSixPoints;
  limits.start_velocity = 0.0;
  RampGenerator ramp;
  ramp.move_to(5, limits);  // v^2 = 2 * 1000 * 5
  EXPECT_NEAR(ramp.remaining_time(), 0.1, 1e-12);
  ramp.advance(99'999_us);
  EXPECT_NEAR(ramp.velocity(), 99.999, 1e-6);
  ramp.advance(2_us);
  EXPECT_EQ(ramp.velocity(), 0.0);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{5, 0.0}));
}

TEST(SixPointRamp, AMoveTooShortForTheStartVelocityStartsSlower) {
  RampLimits limits = kSixPoints;
  limits.end_velocity = 0.0;
  RampGenerator ramp;
  ramp.move_to(1, limits);  // D1 brakes over one microstep from v^2 = 2 * 2000
  EXPECT_NEAR(ramp.velocity(), std::sqrt(4'000.0), 1e-9);
  ramp.advance(1_s);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{1, 0.0}));
}

TEST(SixPointRamp, DurationIsThatOfTheFormula) {
  base::Random random(51);
  for (int i = 0; i < 20'000; ++i) {
    const double v1 = decades(random, 1e2, 1e4);
    const RampLimits limits{.velocity = v1 * decades(random, 1.0, 50.0),
                            .acceleration = decades(random, 1e3, 1e7),
                            .deceleration = decades(random, 1e3, 1e7),
                            .start_velocity = 0.5 * random.uniform() * v1,
                            .start_acceleration = decades(random, 1e3, 1e7),
                            .break_velocity = v1,
                            .final_deceleration = decades(random, 1e3, 1e7),
                            .end_velocity = random.uniform() * v1};
    const auto square = [](double x) { return x * x; };
    const double ways_below =
        (square(v1) - square(limits.start_velocity)) / (2.0 * limits.start_acceleration) +
        (square(v1) - square(limits.end_velocity)) / (2.0 * limits.final_deceleration);
    const auto target =
        static_cast<std::int64_t>(std::ceil(ways_below * decades(random, 1.0, 1e3)) + 1.0);
    const double above = static_cast<double>(target) - ways_below;
    const double slowness = 1.0 / limits.acceleration + 1.0 / limits.deceleration;
    const double peak = std::min(limits.velocity, std::sqrt(square(v1) + 2.0 * above / slowness));
    const double cruise = (above - 0.5 * (square(peak) - square(v1)) * slowness) / peak;
    const double expected = (v1 - limits.start_velocity) / limits.start_acceleration +
                            (peak - v1) * slowness + cruise +
                            (v1 - limits.end_velocity) / limits.final_deceleration;
    RampGenerator ramp;
    ramp.move_to(random.below(2) == 0 ? target : -target, limits);
    ASSERT_NEAR(ramp.remaining_time(), expected, 1e-9 * expected) << "case " << i;
  }
}

/// A ramp generator that decides in every tick, as the chip does.
struct TickedRamp {
  const RampLimits& limits;
  double length;
  double tick;

  [[nodiscard]] double braking(double v) const {
    const auto square = [](double x) { return x * x; };
    const double low = std::min(std::max(v, limits.end_velocity), limits.break_velocity);
    const double below = std::max(0.0, square(low) - square(limits.end_velocity));
    const double above =
        std::max(0.0, square(v) - square(std::max(limits.break_velocity, limits.end_velocity)));
    return below / (2.0 * limits.final_deceleration) + above / (2.0 * limits.deceleration);
  }
  /// Time to the target and speed there.
  [[nodiscard]] std::array<double, 2> run() const {
    double v = limits.start_velocity;
    double x = 0.0;
    std::int64_t ticks = 0;
    bool brakes = false;  // from then on it brakes or keeps its speed
    while (x < length) {
      const double faster = std::min(
          limits.velocity,
          v + tick * (v < limits.break_velocity ? limits.start_acceleration : limits.acceleration));
      if (!brakes && length - x - faster * tick > braking(faster)) {
        v = faster;
      } else {
        brakes = true;
        if (length - x - v * tick <= braking(v)) {
          v = std::max(limits.end_velocity,
                       v - tick * (v > limits.break_velocity ? limits.deceleration
                                                             : limits.final_deceleration));
        }
      }
      x += v * tick;
      ++ticks;
    }
    return {static_cast<double>(ticks) * tick, v};
  }
};

TEST(SixPointRamp, AgreesWithAGeneratorThatDecidesEveryTwoMicroseconds) {
  base::Random random(52);
  for (int i = 0; i < 200; ++i) {
    const RampLimits limits{.velocity = decades(random, 1e3, 1e5),
                            .acceleration = decades(random, 1e4, 1e6),
                            .deceleration = decades(random, 1e4, 1e6),
                            .start_velocity = 100.0 * random.uniform(),
                            .start_acceleration = decades(random, 1e4, 1e6),
                            .break_velocity = decades(random, 2e2, 1e4),
                            .final_deceleration = decades(random, 1e4, 1e6),
                            .end_velocity = 100.0 + 100.0 * random.uniform()};
    const auto target =
        static_cast<std::int64_t>(0.02 * limits.velocity * (1.0 + random.uniform()));
    RampGenerator ramp;
    ramp.move_to(target, limits);
    const double planned = ramp.remaining_time();
    const auto [seconds, speed] = TickedRamp{limits, static_cast<double>(target), 2e-6}.run();
    ASSERT_NEAR(planned, seconds, 8e-4 * seconds + 1e-5)
        << "case " << i << ": " << target << " at " << limits.velocity << " from "
        << limits.start_velocity << " with " << limits.start_acceleration << " to "
        << limits.break_velocity << " with " << limits.acceleration << ", down with "
        << limits.deceleration << " and " << limits.final_deceleration << " to "
        << limits.end_velocity;
    ramp.advance(base::SimDuration(static_cast<std::int64_t>(planned * 1e9) - 1));
    ASSERT_NEAR(ramp.velocity(), speed, 0.05 * speed) << "case " << i;
  }
}

TEST(SixPointRamp, ATargetTooNearIsReturnedToFromRestWhateverTheEndVelocity) {
  RampGenerator ramp;
  ramp.move_to(100'000, kSixPoints);
  ramp.advance(1_s);
  const double here = position_of(ramp);
  ramp.move_to(static_cast<std::int64_t>(here) + 10, kSixPoints);
  double furthest = here;
  double slowest = 1'000.0;
  while (ramp.velocity() > 0.0) {
    furthest = position_of(ramp);
    slowest = ramp.velocity();
    ramp.advance(10_us);
  }
  EXPECT_NEAR(furthest, here + 100.0, 0.01);
  EXPECT_NEAR(slowest, 0.0, 0.1);
  EXPECT_LE(ramp.velocity(), -100.0) << "and the way back begins with the start velocity";
  ramp.advance(10_s);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{static_cast<std::int64_t>(here) + 10, 0.0}));
}

TEST(SixPointRamp, VelocityModeHasStartAndBreakVelocityAndNoEndVelocity) {
  RampGenerator ramp;
  ramp.move_at_velocity(-1'000.0, kSixPoints);
  EXPECT_EQ(ramp.velocity(), -100.0);
  ramp.advance(450_ms);
  EXPECT_NEAR(ramp.velocity(), -750.0, 1e-9);
  ramp.advance(1_s);
  EXPECT_EQ(ramp.velocity(), -1'000.0);
  ramp.move_at_velocity(0.0, kSixPoints);
  ramp.advance(50_ms);
  EXPECT_NEAR(ramp.velocity(), -500.0, 1e-9);
  ramp.advance(200_ms);
  EXPECT_NEAR(ramp.velocity(), -100.0, 1e-9);
  ramp.advance(100_ms);
  EXPECT_EQ(ramp.velocity(), 0.0);
}

TEST(SixPointRamp, BelowABreakVelocityItsOwnRatesAreNeeded) {
  RampLimits limits = kSixPoints;
  limits.start_acceleration = 0.0;
  RampGenerator ramp;
  ramp.move_to(10'000, limits);
  ramp.advance(1_s);
  EXPECT_EQ(ramp.velocity(), 100.0) << "the start velocity is all there is";
  ramp.advance(100_s);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{10'000, 0.0}));
  limits = kSixPoints;
  limits.final_deceleration = 0.0;
  ramp.move_to(0, limits);
  ramp.advance(1_s);
  EXPECT_EQ(ramp.position(), (MicrostepPosition{10'000, 0.0})) << "nothing to brake with";
}

TEST(SixPointRampProperties, ChangesInFlightKeepTheRatesAndTheLastTargetIsReachedExactly) {
  base::Random random(53);
  const auto random_limits = [&random] {
    RampLimits limits{.velocity = decades(random, 1e2, 1e6),
                      .acceleration = decades(random, 1e3, 1e7),
                      .deceleration = decades(random, 1e3, 1e7),
                      .start_velocity = decades(random, 1.0, 1e3),
                      .start_acceleration = decades(random, 1e3, 1e7),
                      .break_velocity = random.below(4) == 0 ? 0.0 : decades(random, 1e1, 1e5),
                      .final_deceleration = decades(random, 1e3, 1e7),
                      .end_velocity = random.below(4) == 0 ? 0.0 : decades(random, 1.0, 1e3)};
    limits.stop_deceleration = random.below(2) == 0 ? 0.0 : decades(random, 1e3, 1e7);
    return limits;
  };
  RampGenerator ramp;
  RampLimits limits = random_limits();
  for (int i = 0; i < 100'000; ++i) {
    if (random.below(3) == 0) {
      limits = random_limits();
      ramp.set_limits(limits);
    }
    if (random.below(8) == 0) {
      ramp.move_at_velocity((random.uniform() - 0.5) * 2.0 * limits.velocity, limits);
      ramp.advance(base::SimDuration(static_cast<std::int64_t>(decades(random, 1e3, 1e8))));
    }
    const MotionState start = ramp.state().now;
    const std::int64_t target = ramp.position().microsteps + random_target(random);
    if (target == ramp.target_position()) {
      continue;
    }
    ramp.move_to(target, limits);
    const MotionPlan& plan = ramp.state().plan;
    for (std::size_t k = 0; k < plan.size(); ++k) {
      const MotionState begin = plan[k].at(0.0);
      const MotionState end = plan[k].at(plan[k].duration);
      const double top = std::max(std::fabs(begin.velocity), std::fabs(end.velocity));
      ASSERT_LE(top, std::max(limits.velocity, std::fabs(start.velocity)) * (1.0 + 1e-9) + 1e-9)
          << i << " segment " << k;
      const double middle = std::fabs(plan[k].at(0.5 * plan[k].duration).velocity);
      const bool low = middle < limits.break_velocity;
      const double rate = std::fabs(begin.acceleration);
      if (plan[k].phase == RampPhase::accelerating) {
        ASSERT_EQ(rate, low ? limits.start_acceleration : limits.acceleration) << i << ' ' << k;
      } else if (plan[k].phase == RampPhase::decelerating) {
        const double end_velocity = std::min(limits.end_velocity, limits.velocity);
        // The end velocity is that of the target: where the ramp only turns round it has no
        // meaning.
        const bool goes_on =
            k + 1 < plan.size() && plan[k + 1].at(0.5 * plan[k + 1].duration).velocity != 0.0;
        ASSERT_EQ(rate, middle < end_velocity && limits.stop_deceleration > 0.0 && !goes_on &&
                                std::fabs(end.velocity) < 1e-6
                            ? limits.stop_deceleration
                        : low ? limits.final_deceleration
                              : limits.deceleration)
            << i << " segment " << k;
      }
      if (k > 0) {
        const MotionState before = plan[k - 1].at(plan[k - 1].duration);
        ASSERT_NEAR(distance(before.position, begin.position), 0.0,
                    1e-8 + 1e-11 * std::fabs(distance(start.position, begin.position)))
            << i << " segment " << k;
      }
    }
    RampGenerator arrived;
    arrived.restore(ramp.state());
    arrived.advance(base::SimDuration(std::llround(ramp.remaining_time() * (1e9 + 1)) + 2));
    ASSERT_EQ(arrived.position(), (MicrostepPosition{target, 0.0})) << i;
    ASSERT_TRUE(arrived.target_reached()) << i;
    ramp.advance(base::SimDuration(std::llround(random.uniform() * ramp.remaining_time() * 1e9)));
  }
}

}  // namespace
}  // namespace stator::control
