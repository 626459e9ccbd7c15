// When a stepper gets run, boost and standby current, and the 32 steps of its driver.
#include "stator/control/motion_controller/coil_current_selector.hpp"

#include <gtest/gtest.h>

namespace stator::control {
namespace {

using namespace base::literals;

constexpr CoilCurrentSettings kSettings{
    .run = 128, .standby = 8, .boost = 200, .standby_delay = 10_ms};

TEST(CoilCurrentSelector, RunCurrentHoldsUntilTheDelayHasPassedThenStandby) {
  CoilCurrentSelector selector;
  EXPECT_EQ(selector.advance(kSettings, RampPhase::constant_velocity, 1_ms), 128);
  EXPECT_EQ(selector.advance(kSettings, RampPhase::standstill, 10_ms), 128);
  EXPECT_EQ(selector.advance(kSettings, RampPhase::standstill, 50_us), 8);
  EXPECT_EQ(selector.advance(kSettings, RampPhase::constant_velocity, 50_us), 128);
  EXPECT_EQ(selector.advance(kSettings, RampPhase::standstill, 1_ms), 128);
}

TEST(CoilCurrentSelector, BoostAppliesWhileSpeedChanges) {
  CoilCurrentSelector selector;
  EXPECT_EQ(selector.advance(kSettings, RampPhase::accelerating, 1_ms), 200);
  EXPECT_EQ(selector.advance(kSettings, RampPhase::decelerating, 1_ms), 200);
  EXPECT_EQ(selector.advance(kSettings, RampPhase::constant_velocity, 1_ms), 128);
}

TEST(CoilCurrentSelector, BoostOfZeroMeansRunCurrent) {
  CoilCurrentSettings settings = kSettings;
  settings.boost = 0;
  CoilCurrentSelector selector;
  EXPECT_EQ(selector.advance(settings, RampPhase::accelerating, 1_ms), 128);
}

TEST(CoilCurrentSelector, ResetStartsTheDelayAnew) {
  CoilCurrentSelector selector;
  selector.advance(kSettings, RampPhase::standstill, 10_ms);
  selector.reset();
  EXPECT_EQ(selector.advance(kSettings, RampPhase::standstill, 1_ms), 128);
}

TEST(CurrentFraction, Has32Steps) {
  EXPECT_EQ(current_fraction(0), 1.0 / 32.0);
  EXPECT_EQ(current_fraction(7), 1.0 / 32.0);
  EXPECT_EQ(current_fraction(8), 2.0 / 32.0);
  EXPECT_EQ(current_fraction(85), 11.0 / 32.0);
  EXPECT_EQ(current_fraction(248), 1.0);
  EXPECT_EQ(current_fraction(255), 1.0);
}

}  // namespace
}  // namespace stator::control
