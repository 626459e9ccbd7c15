// How the TMCM-142's motion controller approaches position limits in flight.
#include <algorithm>

#include <gtest/gtest.h>

#include "stator/control/motion_controller/motion_controller_ramp.hpp"
#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;

constexpr StopConditions kFree{};
constexpr StopConditions kRight{.left = false, .right = true};
constexpr std::int32_t kVelocity = 5'000'000;

RampSettings settings(std::uint32_t deceleration, std::uint32_t stop_deceleration) {
  return {.maximum_velocity = kVelocity,
          .acceleration = 10'000,
          .deceleration = deceleration,
          .stop_deceleration = stop_deceleration};
}

PositionLimits right_limit(std::int32_t position) {
  return {.right = position, .right_enabled = true};
}

/// Advances until the motor no longer moves; returns the rightmost position.
std::int32_t run_to_rest(MotionControllerRamp& ramp, base::SimDuration period) {
  std::int32_t rightmost = ramp.position();
  for (int i = 0; i < 20'000; ++i) {
    ramp.advance(kFree, period);
    rightmost = std::max(rightmost, ramp.position());
    if (ramp.at_rest()) {
      break;
    }
  }
  EXPECT_TRUE(ramp.at_rest());
  return rightmost;
}

TEST(MotionControllerLimits, AMotorThatStillGainsSpeedEndsOnTheLimit) {
  // Periods are long here, so what the velocity will be a period later decides.
  for (std::int32_t limit = 500; limit < 6'000; limit += 50) {
    MotionControllerRamp ramp;
    ramp.configure(settings(10'000, 10'000), right_limit(limit), true);
    ramp.rotate(kVelocity);
    ASSERT_LE(run_to_rest(ramp, 10_ms), limit);
    ASSERT_EQ(ramp.position(), limit);
  }
}

TEST(MotionControllerLimits, BrakingForALimitUsesTheStopDecelerationThoughTurningWouldBeShorter) {
  for (const std::int32_t limit : {3'000, 20'000}) {
    MotionControllerRamp ramp;
    ramp.configure(settings(40'000, 10'000), right_limit(limit), true);
    ramp.rotate(kVelocity);
    EXPECT_LE(run_to_rest(ramp, 100_us), limit);
    EXPECT_EQ(ramp.position(), limit);
  }
}

/// Runs right until the approach of a limit at 40,000 has slowed the motor down.
MotionControllerRamp approaching(const RampSettings& settings) {
  MotionControllerRamp ramp;
  ramp.configure(settings, right_limit(40'000), true);
  ramp.rotate(kVelocity);
  while (ramp.position() < 20'000 || ramp.velocity() == kVelocity) {
    ramp.advance(kFree, 100_us);
  }
  return ramp;
}

TEST(MotionControllerLimits, AMotorThatCanTurnBeforeTheLimitTurnsAtOnce) {
  MotionControllerRamp ramp = approaching(settings(40'000, 10'000));
  ramp.rotate(-1'000'000);
  const std::int32_t velocity = ramp.velocity();
  ramp.advance(kFree, 160_us);
  EXPECT_NEAR(ramp.velocity(), velocity - 10 * 40'000 / 16, 1) << "the usual deceleration";
  std::int32_t rightmost = 0;
  for (int i = 0; i < 5'000; ++i) {
    ramp.advance(kFree, 100_us);
    rightmost = std::max(rightmost, ramp.position());
  }
  EXPECT_LT(rightmost, 38'000);
  EXPECT_EQ(ramp.velocity(), -1'000'000);
}

TEST(MotionControllerLimits, AMotorThatCannotTurnBeforeTheLimitTurnsOnIt) {
  MotionControllerRamp ramp = approaching(settings(10'000, 40'000));
  ramp.rotate(-1'000'000);
  std::int32_t rightmost = 0;
  for (int i = 0; i < 5'000; ++i) {
    ramp.advance(kFree, 100_us);
    rightmost = std::max(rightmost, ramp.position());
  }
  EXPECT_EQ(rightmost, 40'000);
  EXPECT_EQ(ramp.velocity(), -1'000'000);
}

TEST(MotionControllerLimits, ATargetBeyondTheLeftLimitIsReplacedByIt) {
  for (const std::int32_t origin : {0, -4'000}) {  // the counter, and what it was before AP 1
    MotionControllerRamp ramp;
    ramp.configure(settings(10'000, 10'000), {.left = -5'000, .left_enabled = true}, true);
    ramp.set_position(origin);
    ramp.move_to(-10'000);
    std::int32_t leftmost = 0;
    for (int i = 0; i < 20'000; ++i) {
      ramp.advance(kFree, 100_us);
      leftmost = std::min(leftmost, ramp.position());
    }
    EXPECT_EQ(leftmost, -5'000);
    EXPECT_EQ(ramp.position(), -5'000);
    EXPECT_TRUE(ramp.at_rest());
  }
}

TEST(MotionControllerLimits, ATargetBeyondTheLeftLimitIsReplacedAlsoAfterTheCounterHasWrapped) {
  MotionControllerRamp ramp;
  ramp.configure(settings(10'000, 10'000), {}, true);
  ramp.set_position(2'147'483'000);
  ramp.move_to(-2'147'480'000);
  for (int i = 0; i < 20'000; ++i) {
    ramp.advance(kFree, 100_us);
  }
  ASSERT_EQ(ramp.position(), -2'147'480'000);
  ramp.configure(settings(10'000, 10'000), {.left = -2'147'482'000, .left_enabled = true}, true);
  ramp.move_to(-2'147'483'000);
  std::int32_t leftmost = ramp.position();
  for (int i = 0; i < 20'000; ++i) {
    ramp.advance(kFree, 100_us);
    leftmost = std::min(leftmost, ramp.position());
  }
  EXPECT_EQ(leftmost, -2'147'482'000);
  EXPECT_EQ(ramp.position(), -2'147'482'000);
}

TEST(MotionControllerLimits, AMotorToldToTurnTowardsAnActiveSwitchSlowsDownToRest) {
  MotionControllerRamp ramp;
  ramp.configure(settings(10'000, 40'000), {}, true);
  ramp.rotate(-kVelocity);
  for (int i = 0; i < 2'000; ++i) {
    ramp.advance(kRight, 100_us);
  }
  ASSERT_EQ(ramp.velocity(), -kVelocity);
  ramp.rotate(kVelocity);
  ramp.advance(kRight, 160_us);
  EXPECT_EQ(ramp.velocity(), -kVelocity + 10 * 10'000 / 16) << "the usual deceleration";
  for (int i = 0; i < 2'000; ++i) {
    ramp.advance(kRight, 100_us);
  }
  EXPECT_TRUE(ramp.at_rest());
}

}  // namespace
}  // namespace stator::control::motion_controller
