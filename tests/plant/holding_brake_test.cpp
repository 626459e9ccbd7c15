// Voltages and delays at which a holding brake opens and closes.
#include "stator/plant/mechanics/holding_brake.hpp"

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

using namespace base::literals;

TEST(HoldingBrake, ASpringAppliedBrakeOpensFromItsPullInVoltageOn) {
  const HoldingBrake brake{.pull_in_duty = 0.4};
  EXPECT_FALSE(brake.releases(0.0));
  EXPECT_FALSE(brake.releases(0.39));
  EXPECT_TRUE(brake.releases(0.4));
}

TEST(HoldingBrake, APowerOnBrakeClosesInstead) {
  const HoldingBrake brake{.pull_in_duty = 0.4, .closed_by_current = true};
  EXPECT_TRUE(brake.releases(0.0));
  EXPECT_FALSE(brake.releases(1.0));
}

TEST(HoldingBrake, TheArmatureMovesAfterItsDelays) {
  const HoldingBrake brake{.release_time = 2_ms, .apply_time = 3_ms};
  HoldingBrakeState state;
  const auto steps_until = [&](bool open) {
    int steps = 0;
    for (; state.open != open; ++steps) {
      brake.advance(state, open, 1_ms);
    }
    return steps;
  };
  EXPECT_EQ(steps_until(true), 3) << "closed during the first 2 ms";
  EXPECT_EQ(steps_until(false), 4);
}

TEST(HoldingBrake, AShortPulseDoesNotAddUp) {
  const HoldingBrake brake{.release_time = 2_ms};
  HoldingBrakeState state;
  for (int i = 0; i < 10; ++i) {
    brake.advance(state, true, 1_ms);
    brake.advance(state, false, 1_ms);
  }
  EXPECT_FALSE(state.open);
}

}  // namespace
}  // namespace stator::plant
