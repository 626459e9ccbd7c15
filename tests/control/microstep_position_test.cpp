// Positions of microsteps with a fraction: rounding below zero and resolution far from it.
#include "stator/control/microstep_position.hpp"

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::control {
namespace {

TEST(MicrostepPosition, WholePartIsTheFloorAlsoBelowZero) {
  EXPECT_EQ(displaced({0, 0.0}, 2.75), (MicrostepPosition{2, 0.75}));
  EXPECT_EQ(displaced({0, 0.0}, -2.75), (MicrostepPosition{-3, 0.25}));
  EXPECT_EQ(displaced({5, 0.5}, -0.5), (MicrostepPosition{5, 0.0}));
  EXPECT_EQ(displaced({5, 0.5}, -5.5), (MicrostepPosition{0, 0.0}));
}

TEST(MicrostepPosition, FractionStaysBelowOneWhenATinyStepBackRounds) {
  EXPECT_EQ(displaced({7, 0.0}, -1e-20), (MicrostepPosition{7, 0.0}));
}

TEST(MicrostepPosition, KeepsItsResolutionFarOut) {
  const MicrostepPosition far{1'000'000'000'000'000'000, 0.25};
  EXPECT_EQ(distance(far, displaced(far, 0.125)), 0.125);
}

TEST(MicrostepPosition, DisplacementAndDistanceAreInverse) {
  base::Random random(3);
  for (int i = 0; i < 100'000; ++i) {
    const MicrostepPosition from{static_cast<std::int64_t>(random.next() >> 20U), random.uniform()};
    const double displacement = (random.uniform() - 0.5) * 1e7;
    const MicrostepPosition to = displaced(from, displacement);
    ASSERT_GE(to.fraction, 0.0);
    ASSERT_LT(to.fraction, 1.0);
    ASSERT_NEAR(distance(from, to), displacement, 2e-9);
  }
}

}  // namespace
}  // namespace stator::control
