// Trapezoidal ramps of the TMCM-142's motion controller to one unit of its registers against
// analytic ones.
#include "stator/control/motion_controller/motion_controller_ramp.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "control/random_ramps.hpp"
#include "control/trapezoid_reference.hpp"
#include "stator/base/random.hpp"
#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;
using tests::decades;
using tests::TrapezoidReference;

constexpr StopConditions kFree{};

/// The chip's units in microsteps and clocks, straight from A23 and A24.
constexpr long double kVelocityPerClock = 0x1p-30L;
constexpr long double kAccelerationPerClock = 0x1p-42L;

long double clocks(base::SimDuration duration) {
  return static_cast<long double>(duration.nanoseconds()) / 62.5L;
}

std::uint32_t random_register(base::Random& random, double low, double high) {
  return static_cast<std::uint32_t>(decades(random, low, high));
}

struct Range {
  double velocity;
  double acceleration;
  double way;  ///< microsteps, also of the longest ramp
};

constexpr Range kWholeRange{2'147'483'647.0, 16'777'215.0, 2'147'483'647.0};

/// Registers with which no ramp is longer than the range's way, from the present velocity either.
RampSettings random_trapezoid(base::Random& random, const MotionControllerRamp& ramp,
                              const Range& range) {
  const std::uint32_t velocity = random_register(random, 1e3, range.velocity);
  const double speed = std::max(std::fabs(ramp.velocity()), static_cast<double>(velocity));
  const double gentlest = std::max(1.0, 0.5 * speed * speed / 262'144.0 / range.way);
  const double steepest = std::max(gentlest, range.acceleration);
  return {.maximum_velocity = velocity,
          .acceleration = random_register(random, gentlest, steepest),
          .deceleration = random_register(random, gentlest, steepest)};
}

/// A part of what is left of the motion, or somewhat more.
base::SimDuration random_duration(base::Random& random, const MotionControllerRamp& ramp) {
  const double seconds = ramp.generator().remaining_time() * random.uniform() * 1.2;
  return base::SimDuration(1000 + static_cast<std::int64_t>(std::min(seconds, 100.0) * 1e9));
}

TEST(MotionControllerUnits, AreThoseOfTheDocument) {
  // L5878-L5902 with f = 16 MHz; worked figures of the requirements.
  EXPECT_EQ(kVelocityUnit, 2.0 * 16e6 / 2147483648.0);
  EXPECT_EQ(kAccelerationUnit, 16e6 * 16e6 / (16.0 * 256.0) / 1073741824.0);
  EXPECT_NEAR(2147483647.0 * kVelocityUnit, 31'999'999.98, 0.01);
  EXPECT_NEAR(16777215.0 * kAccelerationUnit, 976'562'441.8, 0.05);
  EXPECT_EQ(velocity_of_pps(1), 67);
  EXPECT_EQ(velocity_of_pps(51'200), 3'435'974);
  EXPECT_EQ(velocity_of_pps(-51'200), -3'435'974);
  EXPECT_EQ(pps_of_velocity(500'000), 7'451);
  EXPECT_EQ(pps_of_velocity(2'147'483'647), 32'000'000);
  EXPECT_EQ(pps2_of_acceleration(50'000), 2'910'383);
  EXPECT_EQ(acceleration_of_pps2(2'910'383), 50'000);
  EXPECT_EQ(bow_value(0), 0U);
  EXPECT_EQ(bow_value(1), 1U);
  EXPECT_EQ(bow_value(18), 131'072U);
  // One unit of acceleration more in 256 clocks.
  EXPECT_NEAR(kBowUnit * 256.0 / 16e6, kAccelerationUnit, 1e-12);
}

TEST(MotionControllerUnits, RoundTripsOfWholePpsAreExact) {
  for (std::int64_t pps = -31'999'999; pps <= 31'999'999; pps += 9'973) {
    ASSERT_EQ(pps_of_velocity(velocity_of_pps(pps)), pps);
  }
}

TEST(MotionControllerRamp, CoversTheDocumentsRampLength) {
  // rs = v^2 / a / 2 / 2^18 (RMP-012), 2.56 ms for v 500000 and a 50000.
  MotionControllerRamp ramp;
  ramp.set_mode(Mode::velocity);
  ramp.set_target_velocity(500'000);
  ramp.advance(kFree, 2'560_us);
  EXPECT_EQ(ramp.velocity(), 500'000);
  EXPECT_NEAR(distance({0, 0.0}, ramp.generator().position()),
              0.5 * 500'000.0 * 500'000.0 / 50'000.0 / 262'144.0, 1e-9);
}

/// A ramp and its reference, told the same.
class Pair {
 public:
  void configure(const RampSettings& settings) {
    settings_ = settings;
    ramp.configure(settings, {}, false);
    reference.maximum_velocity = settings.maximum_velocity * kVelocityPerClock;
    reference.acceleration = settings.acceleration * kAccelerationPerClock;
    reference.deceleration = settings.deceleration * kAccelerationPerClock;
  }
  void rotate(std::int32_t velocity) {
    ramp.rotate(velocity);
    reference.rotate(velocity * kVelocityPerClock);
  }
  void move_by(std::int32_t way) {
    const std::int64_t target = ramp.unwrapped_position() + way;
    ramp.move_to(static_cast<std::int32_t>(target));
    reference.move_to(static_cast<long double>(target));
  }
  void advance(base::SimDuration duration) {
    ramp.advance(kFree, duration);
    reference.advance(clocks(duration));
  }
  /// Has the reference begin where the ramp is.
  void synchronise() {
    const MicrostepPosition& here = ramp.generator().position();
    reference.set_state(here.microsteps + static_cast<long double>(here.fraction),
                        ramp.generator().velocity() / 16e6L);
  }
  /// Microsteps.
  [[nodiscard]] double position_error() const {
    const MicrostepPosition& here = ramp.generator().position();
    return static_cast<double>(here.microsteps + static_cast<long double>(here.fraction) -
                               reference.position());
  }
  /// Units of the register.
  [[nodiscard]] double velocity_error() const {
    return static_cast<double>(ramp.velocity() - reference.velocity() / kVelocityPerClock);
  }
  /// What the velocity changes by in one clock.
  [[nodiscard]] double units_per_clock() const {
    return std::max(settings_.acceleration, settings_.deceleration) / 4096.0;
  }

  MotionControllerRamp ramp;
  TrapezoidReference reference;

 private:
  RampSettings settings_;
};

std::int32_t random_sign(base::Random& random) {
  return random.below(2) == 0 ? 1 : -1;
}

void command(base::Random& random, Pair& pair, const Range& range) {
  pair.configure(random_trapezoid(random, pair.ramp, range));
  if (random.below(4) == 0) {
    pair.rotate(static_cast<std::int32_t>(decades(random, 1.0, range.velocity)) *
                random_sign(random));
  } else {
    pair.move_by(static_cast<std::int32_t>(decades(random, 1.0, range.way)) * random_sign(random));
  }
}

TEST(MotionControllerRamp, FollowsTheAnalyticTrapezoidToOneUnitThroughChangesInFlight) {
  base::Random random(457);
  for (int move = 0; move < 100'000; ++move) {
    Pair pair;
    for (int change = 0; change < 3; ++change) {
      command(random, pair, {.velocity = 67'108'864.0, .acceleration = 50'000.0, .way = 1e6});
      pair.advance(random_duration(random, pair.ramp));
      ASSERT_LT(std::fabs(pair.position_error()), 1.0) << "move " << move;
      ASSERT_LE(std::fabs(pair.velocity_error()), 1.0) << "move " << move;
    }
  }
}

/// At the end of its range a ramp turns the last digit of a position into more than a unit of
/// velocity, and the next ramp that into more than a microstep: hence the reference begins each
/// command anew, and may be one clock away in time.
TEST(MotionControllerRamp, DoesSoWithinOneClockInTheWholeRangeOfItsRegisters) {
  base::Random random(458);
  Pair pair;
  for (int move = 0; move < 100'000; ++move) {
    pair.synchronise();
    command(random, pair, kWholeRange);
    for (int look = 0; look < 2; ++look) {
      pair.advance(random_duration(random, pair.ramp));
      ASSERT_LT(std::fabs(pair.position_error()), 1.0) << "move " << move;
      ASSERT_LE(std::fabs(pair.velocity_error()), 1.0 + pair.units_per_clock()) << "move " << move;
    }
  }
}

TEST(MotionControllerRamp, ArrivesExactlyWhateverCameBefore) {
  base::Random random(459);
  MotionControllerRamp ramp;
  for (int move = 0; move < 100'000; ++move) {
    RampSettings settings = random_trapezoid(random, ramp, kWholeRange);
    settings.bow = static_cast<std::uint8_t>(random.below(19));
    const auto target = static_cast<std::int32_t>(random.next());
    ramp.configure(settings, {}, false);
    ramp.move_to(target);
    if (random.below(2) == 0) {
      ramp.advance(kFree, random_duration(random, ramp));
      continue;  // the next move comes in flight
    }
    const double left = ramp.generator().remaining_time();
    ramp.advance(kFree, base::SimDuration(static_cast<std::int64_t>(left * (1e9 + 1e-3)) + 2));
    ASSERT_EQ(ramp.position(), target) << "move " << move;
    ASSERT_EQ(ramp.generator().position().fraction, 0.0) << "move " << move;
    ASSERT_EQ(ramp.velocity(), 0) << "move " << move;
    ASSERT_TRUE(ramp.at_rest()) << "move " << move;
  }
}

TEST(MotionControllerRamp, TargetsCountAsWrappedDifference) {
  MotionControllerRamp ramp;
  ramp.set_position(2'147'483'640);
  ramp.move_to(-2'147'483'640);
  ramp.advance(kFree, 1_s);
  EXPECT_EQ(ramp.position(), -2'147'483'640);
  EXPECT_EQ(ramp.generator().motor_microsteps(), 16);
}

TEST(MotionControllerRamp, VelocityModeRunsAcrossTheEndOfTheCounter) {
  MotionControllerRamp ramp;
  ramp.set_position(2'147'483'647);
  ramp.set_mode(Mode::velocity);
  ramp.set_target_velocity(500'000);
  ramp.advance(kFree, 1_s);
  EXPECT_LT(ramp.position(), -2'147'470'000);
  EXPECT_EQ(ramp.velocity(), 500'000);
}

TEST(MotionControllerRamp, AccelerationAndDecelerationAreSeparate) {
  MotionControllerRamp ramp;
  ramp.configure({.acceleration = 1'000, .deceleration = 4'000}, {}, false);
  ramp.set_mode(Mode::velocity);
  ramp.set_target_velocity(100'000);
  ramp.advance(kFree, 800_us);  // 50 ramp steps of 256 clocks, each 1000 / 16
  EXPECT_EQ(ramp.velocity(), 3'125);
  EXPECT_EQ(ramp.acceleration(), 1'000);
  ramp.set_target_velocity(0);
  ramp.advance(kFree, 80_us);
  EXPECT_EQ(ramp.velocity(), 3'125 - 5 * 4'000 / 16);
  EXPECT_EQ(ramp.acceleration(), -4'000);
}

TEST(MotionControllerRamp, HoldKeepsTheVelocityItIsEnteredWith) {
  MotionControllerRamp ramp;
  ramp.configure({.acceleration = 1'000, .deceleration = 4'000, .bow = 3}, {}, false);
  ramp.set_mode(Mode::velocity);
  ramp.set_target_velocity(100'000);
  ramp.advance(kFree, 4_ms);
  const std::int32_t velocity = ramp.velocity();
  ASSERT_GT(velocity, 1'000);
  ASSERT_LT(velocity, 99'000);
  ramp.set_mode(Mode::hold);
  ramp.set_target_velocity(-5);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.velocity(), velocity);
  ramp.set_mode(Mode::velocity);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.velocity(), -5);
}

TEST(MotionControllerRamp, ABowAboveTheAccelerationIsTold) {
  MotionControllerRamp ramp;
  ramp.configure({.acceleration = 1'024, .deceleration = 2'000, .bow = 11}, {}, false);
  EXPECT_FALSE(ramp.bow_too_large());
  ramp.configure({.acceleration = 1'023, .deceleration = 2'000, .bow = 11}, {}, false);
  EXPECT_TRUE(ramp.bow_too_large());
  ramp.configure({.acceleration = 2'000, .deceleration = 1'000, .bow = 11}, {}, false);
  EXPECT_TRUE(ramp.bow_too_large());
  ramp.configure({.acceleration = 1, .deceleration = 1, .bow = 0}, {}, false);
  EXPECT_FALSE(ramp.bow_too_large());
}

TEST(MotionControllerRamp, AWrittenPositionMovesNothingButChangesTheWay) {
  MotionControllerRamp ramp;
  ramp.move_to(1'000);
  ramp.advance(kFree, 10_s);
  ramp.set_position(900);
  EXPECT_EQ(ramp.position(), 900);
  EXPECT_EQ(ramp.generator().motor_microsteps(), 1'000);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), 1'000);
  EXPECT_EQ(ramp.generator().motor_microsteps(), 1'100);
  EXPECT_EQ(ramp.target_position(), 1'000);
}

}  // namespace
}  // namespace stator::control::motion_controller
