// Errors of measured currents: gain, offset, resolution, range, noise by its seed.
#include "stator/plant/sensors/current_sensing.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

TEST(CurrentSensing, WithoutErrorsItIsExact) {
  EXPECT_TRUE(CurrentSensing({}).exact());
  base::Random random(1);
  EXPECT_EQ(CurrentSensing({}).measure({1.0, -2.0, 1.0}, random), (std::array{1.0, -2.0, 1.0}));
}

TEST(CurrentSensing, GainOffsetQuantisationAndRangeActInTurn) {
  base::Random random(1);
  const CurrentSensing sensing(
      {.gain = {1.1, 1.0, 1.0}, .offset = {0.0, 0.3, 0.0}, .resolution = 0.25, .range = 5.0});
  const auto measured = sensing.measure({1.0, 1.0, -20.0}, random);
  EXPECT_EQ(measured[0], 1.0);   // 1.1
  EXPECT_EQ(measured[1], 1.25);  // 1.3
  EXPECT_EQ(measured[2], -5.0);
}

TEST(CurrentSensing, NoiseHasItsDeviationAndNoMean) {
  base::Random random(7);
  const CurrentSensing sensing({.noise = 0.2});
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kSamples = 20'000;
  for (int n = 0; n < kSamples; ++n) {
    const double value = sensing.measure({}, random)[1];
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kSamples, 0.0, 0.006);
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.2, 0.004);
}

TEST(CurrentSensing, TheSameSeedGivesTheSameNoise) {
  base::Random one(42);
  base::Random same(42);
  base::Random other(43);
  const CurrentSensing sensing({.noise = 0.2});
  const auto measured = sensing.measure({}, one);
  EXPECT_EQ(measured, sensing.measure({}, same));
  EXPECT_NE(measured, sensing.measure({}, other));
}

}  // namespace
}  // namespace stator::plant
