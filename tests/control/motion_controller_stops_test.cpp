// Hard and soft stops at switches and position limits of the TMCM-142's motion controller.
#include <cmath>

#include <gtest/gtest.h>

#include "control/random_ramps.hpp"
#include "stator/base/random.hpp"
#include "stator/control/motion_controller/motion_controller_ramp.hpp"
#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace base::literals;
using tests::decades;

constexpr StopConditions kFree{};
constexpr StopConditions kRight{.left = false, .right = true};
constexpr StopConditions kLeft{.left = true, .right = false};
constexpr RampSettings kSettings{.maximum_velocity = 5'000'000,
                                 .acceleration = 10'000,
                                 .deceleration = 10'000,
                                 .stop_deceleration = 40'000};

/// Runs right or left at 5,000,000.
MotionControllerRamp running(bool soft_stop, std::int32_t velocity,
                             const PositionLimits& limits = {}) {
  MotionControllerRamp ramp;
  ramp.configure(kSettings, limits, soft_stop);
  ramp.set_mode(Mode::velocity);
  ramp.set_target_velocity(velocity);
  for (int i = 0; i < 2'000; ++i) {
    ramp.advance(kFree, 100_us);
  }
  return ramp;
}

TEST(MotionControllerStops, AHardStopActsAtOnceAndInItsDirectionOnly) {
  MotionControllerRamp ramp = running(false, 5'000'000);
  ASSERT_EQ(ramp.velocity(), 5'000'000);
  const std::int32_t position = ramp.position();
  ramp.advance(kLeft, 100_us);
  EXPECT_EQ(ramp.velocity(), 5'000'000);
  EXPECT_GT(ramp.position(), position);
  const MicrostepPosition there = ramp.generator().position();
  ramp.advance(kRight, 100_us);
  EXPECT_EQ(ramp.velocity(), 0);
  EXPECT_EQ(ramp.generator().position(), there);
  ramp.advance(kRight, 1_s);
  EXPECT_EQ(ramp.generator().position(), there);
  ramp.set_target_velocity(-5'000'000);
  ramp.advance(kRight, 1_ms);
  EXPECT_EQ(ramp.velocity(), -10'000 * 1'000 / 256);  // 62.5 ramp steps of 10000 / 16
}

TEST(MotionControllerStops, ASoftStopUsesTheStopDeceleration) {
  MotionControllerRamp ramp = running(true, -5'000'000);
  ramp.advance(kLeft, 160_us);
  EXPECT_EQ(ramp.velocity(), -5'000'000 + 10 * 40'000 / 16);
  ramp.advance(kLeft, 100_ms);
  EXPECT_EQ(ramp.velocity(), 0);
  EXPECT_TRUE(ramp.at_rest());
}

TEST(MotionControllerStops, AfterASoftStopTheMotorGoesWhereItWasToldMeanwhile) {
  MotionControllerRamp ramp = running(true, 5'000'000);
  ramp.advance(kRight, 1_ms);
  ramp.rotate(-1'000'000);
  ramp.advance(kRight, 160_us);
  EXPECT_EQ(ramp.velocity(), 5'000'000 - 1'160 * 40'000 / 256) << "still with AP 15";
  for (int i = 0; i < 1'000; ++i) {
    ramp.advance(kRight, 100_us);
  }
  EXPECT_EQ(ramp.velocity(), -1'000'000);
}

TEST(MotionControllerStops, TheMotionGoesOnWhenTheConditionGoes) {
  MotionControllerRamp ramp;
  ramp.configure(kSettings, {}, false);
  ramp.move_to(100'000);
  ramp.advance(kFree, 100_ms);
  ramp.advance(kRight, 1_ms);
  ASSERT_TRUE(ramp.at_rest());
  ASSERT_NE(ramp.position(), 100'000);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), 100'000);
}

TEST(MotionControllerStops, AWayBackIntoAnActiveSwitchIsNotTaken) {
  // Too fast leftwards for a target near by: the plan would come back from beyond it.
  MotionControllerRamp ramp = running(false, -5'000'000);
  ramp.move_to(ramp.position() - 10);
  std::int32_t leftmost = ramp.position();
  for (int i = 0; i < 10'000; ++i) {
    ramp.advance(kRight, 100_us);
    leftmost = std::min(leftmost, ramp.position());
    ASSERT_LE(ramp.position(), leftmost + 1);
  }
  EXPECT_TRUE(ramp.at_rest());
  EXPECT_LT(ramp.position(), ramp.target_position());
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), ramp.target_position());
}

TEST(MotionControllerStops, AStandingMotorDoesNotCreepIntoAnActiveSwitch) {
  MotionControllerRamp ramp;
  ramp.configure(kSettings, {}, true);
  ramp.advance(kRight, 100_us);
  ramp.move_to(1'000);
  for (int i = 0; i < 1'000; ++i) {
    ramp.advance(kRight, 100_us);
    ASSERT_EQ(ramp.generator().position(), MicrostepPosition{});
  }
}

TEST(MotionControllerStops, HoldModeStopsAtASwitchToo) {
  MotionControllerRamp ramp = running(false, 5'000'000);
  ramp.set_mode(Mode::hold);
  ramp.advance(kFree, 100_us);
  ASSERT_EQ(ramp.velocity(), 5'000'000);
  ramp.advance(kRight, 100_us);
  EXPECT_EQ(ramp.velocity(), 0);
}

TEST(MotionControllerLimits, ATargetBeyondALimitLeadsToTheLimit) {
  MotionControllerRamp ramp;
  ramp.configure(kSettings, {.right = 5'000, .left = -3'000, .right_enabled = true}, false);
  ramp.move_to(20'000);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), 5'000);
  EXPECT_EQ(ramp.target_position(), 20'000);
  ramp.move_to(-20'000);  // the left one is not enabled
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), -20'000);
  ramp.configure(kSettings,
                 {.right = 5'000, .left = -3'000, .right_enabled = true, .left_enabled = true},
                 false);
  ramp.move_to(-30'000);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), -20'000) << "beyond a limit only the way back is open";
  ramp.move_to(0);
  ramp.advance(kFree, 10_s);
  EXPECT_EQ(ramp.position(), 0);
}

TEST(MotionControllerLimits, VelocityModeEndsOnTheLimitSoftlyOrHard) {
  for (const bool soft : {false, true}) {
    SCOPED_TRACE(soft);
    const PositionLimits limits{
        .right = 40'000, .left = -40'001, .right_enabled = true, .left_enabled = true};
    for (const std::int32_t velocity : {5'000'000, -5'000'000}) {
      MotionControllerRamp ramp;
      ramp.configure(kSettings, limits, soft);
      ramp.set_mode(Mode::velocity);
      ramp.set_target_velocity(velocity);
      std::int32_t slowest_change = 0;
      std::int32_t before = 0;
      for (int i = 0; i < 20'000; ++i) {
        ramp.advance(kFree, 100_us);
        slowest_change = std::max(slowest_change, std::abs(before) - std::abs(ramp.velocity()));
        before = ramp.velocity();
        ASSERT_LE(ramp.position(), 40'000);
        ASSERT_GE(ramp.position(), -40'001);
      }
      EXPECT_EQ(ramp.generator().position(),
                (MicrostepPosition{velocity > 0 ? limits.right : limits.left, 0.0}));
      // 6.25 ramp steps a period: 40000 / 16 * 6.25 = 15625 units.
      EXPECT_EQ(slowest_change, soft ? 15'625 : 5'000'000);
      ramp.set_target_velocity(-velocity);
      ramp.advance(kFree, 160_us);
      EXPECT_EQ(ramp.velocity(), velocity > 0 ? -6'250 : 6'250) << "away at once";
    }
  }
}

TEST(MotionControllerLimits, CommandsRepeatedWhileBrakingDoNotCarryTheMotorBeyond) {
  const PositionLimits limits{.right = 40'000, .right_enabled = true};
  MotionControllerRamp ramp;
  for (int i = 0; i < 20'000; ++i) {
    RampSettings settings = kSettings;
    settings.acceleration += static_cast<std::uint32_t>(i % 2);
    ramp.configure(settings, limits, true);
    ramp.rotate(5'000'000);
    ramp.advance(kFree, 100_us);
    ASSERT_LE(ramp.position(), 40'000);
  }
  EXPECT_EQ(ramp.generator().position(), (MicrostepPosition{40'000, 0.0}));
}

TEST(MotionControllerLimits, HoldEveryRandomMotion) {
  base::Random random(53);
  for (int run = 0; run < 2'000; ++run) {
    SCOPED_TRACE(run);
    const auto right = static_cast<std::int32_t>(decades(random, 1e3, 1e6));
    const PositionLimits limits{
        .right = right, .left = -right, .right_enabled = true, .left_enabled = true};
    MotionControllerRamp ramp;
    for (int change = 0; change < 8; ++change) {
      const auto between = [&](double low, double high) {
        return static_cast<std::uint32_t>(decades(random, low, high));
      };
      RampSettings settings{.maximum_velocity = between(1e4, 1e8),
                            .acceleration = between(1e3, 1e5),
                            .deceleration = between(1e3, 1e5),
                            .stop_deceleration = between(1e3, 1e5),
                            .bow = static_cast<std::uint8_t>(random.below(19))};
      ramp.configure(settings, limits, false);
      if (random.below(2) == 0) {
        ramp.move_to(static_cast<std::int32_t>(random.below(4'000'000)) - 2'000'000);
      } else {
        ramp.set_mode(Mode::velocity);
        ramp.set_target_velocity(static_cast<std::int32_t>(random.below(200'000'000)) -
                                 100'000'000);
      }
      for (std::uint64_t tick = random.below(300); tick > 0; --tick) {
        ramp.advance(kFree, 100_us);
        // Where a new command shortened the way too late, the motor stops in the period it passes
        // the limit in.
        const double reach = std::fabs(ramp.velocity()) * kVelocityUnit * 1e-4 + 160.0;
        ASSERT_LE(std::abs(ramp.position()), right + reach);
      }
    }
  }
}

TEST(MotionControllerLimits, AreNotLookedAtWhileIgnored) {
  MotionControllerRamp ramp = running(false, 5'000'000, {.right = 1'000, .right_enabled = true});
  ASSERT_EQ(ramp.position(), 1'000);
  ramp.ignore_limits(true);
  ramp.advance(kFree, 100_ms);
  EXPECT_GT(ramp.position(), 1'001);
}

}  // namespace
}  // namespace stator::control::motion_controller
