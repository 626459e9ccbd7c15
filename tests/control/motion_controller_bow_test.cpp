// S-shaped ramps of the TMCM-142's motion controller against analytic moves with constant jerks.
#include <cmath>

#include <gtest/gtest.h>

#include "control/ramp_audit.hpp"
#include "control/random_ramps.hpp"
#include "stator/base/random.hpp"
#include "stator/control/motion_controller/motion_controller_ramp.hpp"
#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;
using tests::decades;

constexpr StopConditions kFree{};
constexpr long double kClocksPerSecond = 16e6L;
constexpr long double kVelocityPerClock = 0x1p-30L;
constexpr long double kAccelerationPerClock = 0x1p-42L;
constexpr long double kBowPerClock = 0x1p-50L;

/// Position and velocity that constant jerks lead to; microsteps and clocks.
struct JerkIntegral {
  long double position = 0.0L;
  long double velocity = 0.0L;
  long double acceleration = 0.0L;

  void pass(long double time, long double jerk) {
    position += time * (velocity + time * (acceleration / 2.0L + time * jerk / 6.0L));
    velocity += time * (acceleration + time * jerk / 2.0L);
    acceleration += time * jerk;
  }
};

/// An S-shaped move from rest to rest over a way, from its definition: the peak velocity is found
/// by bisection, the rest is time.
class BowReference {
 public:
  BowReference(long double way, const RampSettings& settings)
      : jerk_(static_cast<long double>(bow_value(settings.bow)) * kBowPerClock),
        up_(settings.acceleration * kAccelerationPerClock),
        down_(settings.deceleration * kAccelerationPerClock) {
    long double low = 0.0L;
    long double high = settings.maximum_velocity * kVelocityPerClock;
    if (ramps(high) > way) {
      for (int step = 0; step < 120; ++step) {
        const long double middle = 0.5L * (low + high);
        (ramps(middle) > way ? high : low) = middle;
      }
    }
    peak_ = high;
    cruise_ = std::max(0.0L, way - ramps(peak_)) / peak_;
  }

  [[nodiscard]] long double duration() const {
    return time(peak_, up_) + cruise_ + time(peak_, down_);
  }
  [[nodiscard]] JerkIntegral at(long double when) const {
    JerkIntegral state;
    change(state, when, up_, 1.0L);
    run(state, when, cruise_, 0.0L);
    change(state, when, down_, -1.0L);
    return state;
  }

 private:
  /// Largest acceleration on the way from rest to a velocity.
  [[nodiscard]] long double top(long double velocity, long double rate) const {
    return std::min(rate, std::sqrt(velocity * jerk_));
  }
  [[nodiscard]] long double time(long double velocity, long double rate) const {
    return velocity / top(velocity, rate) + top(velocity, rate) / jerk_;
  }
  /// By symmetry half the peak velocity on average, up and down.
  [[nodiscard]] long double ramps(long double velocity) const {
    return 0.5L * velocity * (time(velocity, up_) + time(velocity, down_));
  }
  static void run(JerkIntegral& state, long double& left, long double length, long double jerk) {
    const long double part = std::min(left, length);
    state.pass(part, jerk);
    left -= part;
  }
  void change(JerkIntegral& state, long double& left, long double rate, long double sign) const {
    const long double bow = top(peak_, rate) / jerk_;
    run(state, left, bow, sign * jerk_);
    run(state, left, time(peak_, rate) - 2.0L * bow, 0.0L);
    run(state, left, bow, -sign * jerk_);
  }

  long double jerk_;
  long double up_;
  long double down_;
  long double peak_ = 0.0L;
  long double cruise_ = 0.0L;
};

RampSettings random_bow(base::Random& random) {
  const auto between = [&](double low, double high) {
    return static_cast<std::uint32_t>(decades(random, low, high));
  };
  return {.maximum_velocity = between(1e4, 134'217'728.0),
          .acceleration = between(1e3, 1'000'000.0),
          .deceleration = between(1e3, 1'000'000.0),
          .bow = static_cast<std::uint8_t>(1 + random.below(18))};
}

TEST(MotionControllerBow, ChangesTheAccelerationByItsValueEvery256Clocks) {
  MotionControllerRamp ramp;
  ramp.configure({.acceleration = 50'000, .deceleration = 50'000, .bow = 6}, {}, false);
  ramp.set_mode(Mode::velocity);
  ramp.set_target_velocity(100'000'000);
  ramp.advance(kFree, 1'600_us);  // 100 ramp steps of 32 each
  EXPECT_EQ(ramp.acceleration(), 3'200);
  EXPECT_EQ(ramp.velocity(), 100 * 3'200 / 2 / 16);
  ramp.advance(kFree, 100_ms);
  EXPECT_EQ(ramp.acceleration(), 50'000);
}

TEST(MotionControllerBow, MovesFromRestAreTheAnalyticOnesToOneUnit) {
  base::Random random(18);
  for (int move = 0; move < 100'000; ++move) {
    const RampSettings settings = random_bow(random);
    const auto way = static_cast<std::int32_t>(decades(random, 1.0, 1e7));
    const bool forward = random.below(2) == 0;
    const BowReference reference(way, settings);
    MotionControllerRamp ramp;
    ramp.configure(settings, {}, false);
    ramp.move_to(forward ? way : -way);
    const auto when = static_cast<std::int64_t>(static_cast<double>(reference.duration()) * 62.5 *
                                                random.uniform() * 1.1);
    ramp.advance(kFree, base::SimDuration(when));
    JerkIntegral expected = reference.at(static_cast<long double>(when) / 62.5L);
    const double sign = forward ? 1.0 : -1.0;
    ASSERT_NEAR(sign * distance({0, 0.0}, ramp.generator().position()),
                static_cast<double>(expected.position), 1e-3)
        << "move " << move;
    ASSERT_NEAR(sign * ramp.velocity(), static_cast<double>(expected.velocity / kVelocityPerClock),
                1.0)
        << "move " << move;
  }
}

/// Integrates what a ramp has planned.
JerkIntegral integrated(const JerkIntegral& start, const MotionPlan& plan, long double seconds) {
  JerkIntegral state = start;
  for (std::size_t i = 0; i < plan.size() && seconds > 0.0L; ++i) {
    const MotionSegment& segment = plan[i];
    const long double length =
        i + 1 < plan.size() ? std::min<long double>(seconds, segment.duration) : seconds;
    state.acceleration = segment.at(0.0).acceleration / kClocksPerSecond / kClocksPerSecond;
    state.pass(length * kClocksPerSecond,
               segment.jerk / kClocksPerSecond / kClocksPerSecond / kClocksPerSecond);
    seconds -= length;
  }
  return state;
}

TEST(MotionControllerBow, ChangesInFlightKeepTheBowAndTheirIntegralToOneUnit) {
  base::Random random(19);
  MotionControllerRamp ramp;
  for (int move = 0; move < 100'000; ++move) {
    if (move % 50 == 0) {
      ramp = MotionControllerRamp();
    }
    ramp.configure(random_bow(random), {}, false);
    const tests::Start start(ramp.generator());
    if (random.below(3) == 0) {
      ramp.set_mode(Mode::velocity);
      ramp.set_target_velocity(static_cast<std::int32_t>(decades(random, 1.0, 134'217'728.0)) *
                               (random.below(2) == 0 ? 1 : -1));
    } else {
      const auto way = static_cast<std::int64_t>(decades(random, 1.0, 1e7));
      ramp.move_to(static_cast<std::int32_t>(ramp.unwrapped_position() +
                                             (random.below(2) == 0 ? way : -way)));
    }
    const RampState& planned = ramp.generator().state();
    const MotionPlan plan = planned.plan;
    tests::BowAudit(start, plan, planned.limits).check();
    ASSERT_FALSE(HasFailure()) << "move " << move;
    const MicrostepPosition& from = start.state.position;
    const JerkIntegral begin{from.microsteps + static_cast<long double>(from.fraction),
                             start.state.velocity / kClocksPerSecond, 0.0L};
    const double left = ramp.generator().remaining_time();
    const base::SimDuration duration(
        1'000 + static_cast<std::int64_t>(std::min(10.0, left * 1.1) * random.uniform() * 1e9));
    ramp.advance(kFree, duration);
    const JerkIntegral expected = integrated(begin, plan, duration.nanoseconds() * 1e-9L);
    const MicrostepPosition& here = ramp.generator().position();
    ASSERT_NEAR(static_cast<double>(here.microsteps + static_cast<long double>(here.fraction) -
                                    expected.position),
                0.0, 1.0)
        << "move " << move;
    ASSERT_NEAR(ramp.velocity() - static_cast<double>(expected.velocity / kVelocityPerClock), 0.0,
                1.0)
        << "move " << move;
  }
}

}  // namespace
}  // namespace stator::control::motion_controller
