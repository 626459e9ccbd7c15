#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "control/random_ramps.hpp"
#include "stator/control/ramp/ramp_generator.hpp"

// Properties of the trapezoid that hold for every start, target and limit, over seeded random
// cases.

namespace stator::control {
namespace {

using namespace base::literals;
using tests::check_mirrored_traces;
using tests::check_traces_of_any_tick;
using tests::decades;
using tests::random_target;

RampLimits random_limits(base::Random& random) {
  return {.velocity = decades(random, 1e2, 1e6),
          .acceleration = decades(random, 1e3, 1e7),
          .deceleration = decades(random, 1e3, 1e7)};
}

/// Duration of a trapezoid from rest over `length` microsteps.
double duration_from_rest(double length, const RampLimits& limits) {
  const double a = limits.acceleration;
  const double d = limits.deceleration;
  const double peak = std::min(limits.velocity, std::sqrt(2.0 * a * d * length / (a + d)));
  const double ramps = 0.5 * peak * peak * (1.0 / a + 1.0 / d);
  return peak / a + peak / d + (length - ramps) / peak;
}

TEST(RampProperties, DurationFromRestIsTheAnalyticOneAndArrivalIsExact) {
  base::Random random(11);
  for (int i = 0; i < 20'000; ++i) {
    const RampLimits limits = random_limits(random);
    const std::int64_t target = random_target(random);
    RampGenerator ramp;
    ramp.move_to(target, limits);
    const double expected = duration_from_rest(std::fabs(static_cast<double>(target)), limits);
    ASSERT_NEAR(ramp.remaining_time(), expected, 1e-9 * expected) << "case " << i;
    ramp.advance(base::SimDuration(static_cast<std::int64_t>(expected * 1e9 * (1.0 + 1e-9)) + 1));
    ASSERT_EQ(ramp.position(), (MicrostepPosition{target, 0.0})) << "case " << i;
    ASSERT_EQ(ramp.velocity(), 0.0) << "case " << i;
    ASSERT_TRUE(ramp.target_reached()) << "case " << i;
  }
}

/// Watches one generator and fails when a tick breaks the kinematics of the limits in force.
class Watch {
 public:
  explicit Watch(const RampGenerator& ramp) : ramp_(ramp) { note(); }

  void note() {
    position_ = ramp_.position();
    velocity_ = ramp_.velocity();
  }

  /// Call after a tick of `seconds` during which only `limits` were in force.
  void check(double seconds, const RampLimits& limits) {
    const double before = velocity_;
    const double moved = distance(position_, ramp_.position());
    note();
    const double speed = std::fabs(velocity_);
    const double speed_before = std::fabs(before);
    const double rounding = 1e-9 * (1.0 + speed_before);
    ASSERT_LE(speed, std::max(limits.velocity, speed_before) + rounding);
    if (speed > limits.velocity + rounding) {  // on the way down to a lowered limit
      ASSERT_NEAR(speed, speed_before - limits.deceleration * seconds,
                  limits.deceleration * seconds * 1e-6 + rounding);
    }
    const bool same_direction = before * velocity_ >= 0.0;
    const double gained = speed - speed_before;
    if (same_direction) {
      ASSERT_LE(gained, limits.acceleration * seconds + rounding);
      ASSERT_LE(-gained, limits.deceleration * seconds + rounding);
    }
    const double largest = std::max(limits.acceleration, limits.deceleration);
    ASSERT_NEAR(moved, 0.5 * (before + velocity_) * seconds,
                0.25 * largest * seconds * seconds + 1e-8);
  }

 private:
  const RampGenerator& ramp_;
  MicrostepPosition position_;
  double velocity_ = 0.0;
};

TEST(RampProperties, ChangesInFlightNeverBreakLimitsAndTheLastTargetIsReachedExactly) {
  base::Random random(12);
  for (int i = 0; i < 3'000; ++i) {
    SCOPED_TRACE(i);
    RampGenerator ramp;
    Watch watch(ramp);
    RampLimits limits = random_limits(random);
    RampLimits in_force = limits;  // a stop keeps the deceleration it was given
    ramp.move_to(random_target(random), limits);
    for (int change = 0; change < 10; ++change) {
      switch (random.below(5)) {
        case 0:
          ramp.move_to(random_target(random), limits);
          in_force = limits;
          break;
        case 1:
          ramp.move_at_velocity((random.uniform() - 0.5) * 2.0 * limits.velocity, limits);
          in_force = limits;
          break;
        case 2:
          limits = random_limits(random);
          ramp.set_limits(limits);
          in_force = ramp.mode() == RampMode::stop ? in_force : limits;
          break;
        case 3:
          ramp.stop(limits.deceleration);
          in_force = limits;
          break;
        default:
          limits = random_limits(random);
          ramp.move_to(random_target(random), limits);
          in_force = limits;
          break;
      }
      watch.note();
      const auto ticks = 1 + random.below(40);
      for (std::uint64_t tick = 0; tick < ticks; ++tick) {
        const base::SimDuration length(static_cast<std::int64_t>(1'000 + random.below(2'000'000)));
        ramp.advance(length);
        watch.check(length.seconds(), in_force);
        if (HasFatalFailure()) {
          return;
        }
      }
    }
    const std::int64_t target = random_target(random);
    ramp.move_to(target, limits);
    const double remaining = ramp.remaining_time();
    ramp.advance(base::SimDuration(static_cast<std::int64_t>(remaining * 1e9) + 2));
    ASSERT_EQ(ramp.position(), (MicrostepPosition{target, 0.0}));
    ASSERT_EQ(ramp.velocity(), 0.0);
  }
}

TEST(RampProperties, TheTraceDoesNotDependOnTheTick) {
  base::Random random(13);
  check_traces_of_any_tick(random, random_limits, {.position = 1e-9, .velocity = 1e-9});
}

TEST(RampProperties, MirroredCommandsGiveTheMirroredTrace) {
  base::Random random(14);
  check_mirrored_traces(random, 500, random_limits, {.position = 1e-9, .velocity = 1e-6});
}

TEST(RampProperties, FromRestTheApproachIsMonotone) {
  base::Random random(15);
  for (int i = 0; i < 500; ++i) {
    const RampLimits limits = random_limits(random);
    const std::int64_t target = 1 + static_cast<std::int64_t>(decades(random, 1.0, 1e5));
    RampGenerator ramp;
    ramp.move_to(target, limits);
    MicrostepPosition before = ramp.position();
    for (int tick = 0; tick < 20'000 && !ramp.at_rest(); ++tick) {
      ramp.advance(50_us);
      ASSERT_GE(distance(before, ramp.position()), -1e-9) << "case " << i;
      ASSERT_LE(distance({target, 0.0}, ramp.position()), 0.0) << "case " << i;
      before = ramp.position();
    }
  }
}

}  // namespace
}  // namespace stator::control
