// StealthChop: below which speed it acts, and the voltage it puts at the coils.
#include "stator/control/stepper/stealth_chop.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace stator::control {
namespace {

TEST(StealthChop, IsActiveBelowItsThresholdOnly) {
  EXPECT_TRUE((StealthChopSettings{1000.0, 1, 64}.active_at(999.0)));
  EXPECT_FALSE((StealthChopSettings{1000.0, 1, 64}.active_at(1000.0)));
  EXPECT_FALSE((StealthChopSettings{0.0, 1, 64}.active_at(0.0))) << "threshold 0: off";
  EXPECT_FALSE((StealthChopSettings{1000.0, 0, 64}.active_at(0.0))) << "gradient 0: off";
}

TEST(StealthChop, TheAmplitudeGrowsWithSpeedUpToTheSupply) {
  const StealthChopSettings settings{1e6, 19, 100};
  EXPECT_NEAR(stealth_chop_duty(settings, 0.0, 1.0), 100.0 / 255.0, 1e-12);
  EXPECT_NEAR(stealth_chop_duty(settings, 0.0, 0.25), 25.0 / 255.0, 1e-12);
  // TSTEP = 16e6 / 51200 = 312.5 clocks
  EXPECT_NEAR(stealth_chop_duty(settings, 51'200.0, 1.0), (100.0 + 19.0 * 256.0 / 312.5) / 255.0,
              1e-12);
  EXPECT_EQ(stealth_chop_duty(settings, 1e6, 1.0), 1.0);
}

TEST(StealthChop, TheVoltagePointsWhereTheCurrentIsWanted) {
  const auto duty = coil_duty({1.5, -2.0}, 0.5);
  EXPECT_NEAR(duty[0], 0.3, 1e-12);
  EXPECT_NEAR(duty[1], -0.4, 1e-12);
  EXPECT_EQ(coil_duty({0.0, 0.0}, 0.5), (std::array{0.0, 0.0}));
}

}  // namespace
}  // namespace stator::control
