// Errors of an encoder: eccentricity, missed and extra edges, a highest frequency.
#include "stator/plant/sensors/encoder_disturbance.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

TEST(EncoderDisturbance, EccentricityErrsOncePerRevolution) {
  const EncoderDisturbance disturbance({.eccentricity = 0.01, .eccentricity_phase = 0.3}, 4);
  for (int n = -40; n < 40; ++n) {
    const double shaft = 0.17 * n;
    const double electrical = 4.0 * shaft;
    const double whole = std::floor(electrical / base::kTwoPi);
    const ElectricalAngle angle{static_cast<std::int64_t>(whole),
                                electrical - whole * base::kTwoPi};
    const double error = electrical_radians(disturbance.seen(angle)) / 4.0 - shaft;
    EXPECT_NEAR(error, 0.01 * std::sin(shaft + 0.3), 1e-12) << shaft;
  }
}

TEST(EncoderDisturbance, WithoutErrorsTheDriveSeesTheCount) {
  const EncoderDisturbance disturbance({}, 4);
  EncoderDisturbanceState state;
  EXPECT_EQ(disturbance.update(state, 1000, 1e-6), 1000);
  EXPECT_EQ(disturbance.update(state, -70, 1e-6), -70);
}

TEST(EncoderDisturbance, MissedEdgesAreLostInTheDirectionOfMotion) {
  const EncoderDisturbance disturbance({.missed_edge_probability = 0.01}, 4);
  EncoderDisturbanceState state;
  std::int64_t seen = 0;
  for (int n = 1; n <= 10'000; ++n) {
    seen = disturbance.update(state, n * 10, 20e-6);
  }
  EXPECT_NEAR(static_cast<double>(100'000 - seen), 1000.0, 100.0);
  const std::int64_t lost_forward = 100'000 - seen;
  for (int n = 10'000; n >= 0; --n) {
    seen = disturbance.update(state, n * 10, 20e-6);
  }
  // As many are lost on the way back, which brings the count nearly to where it was.
  EXPECT_LT(std::llabs(seen), lost_forward / 2);
}

TEST(EncoderDisturbance, ExtraEdgesAreCountedTwice) {
  const EncoderDisturbance disturbance({.extra_edge_probability = 0.02}, 4);
  EncoderDisturbanceState state;
  std::int64_t seen = 0;
  for (int n = 1; n <= 10'000; ++n) {
    seen = disturbance.update(state, n * 10, 20e-6);
  }
  EXPECT_NEAR(static_cast<double>(seen - 100'000), 2000.0, 200.0);
}

TEST(EncoderDisturbance, BeyondTheHighestFrequencyCountsGetLost) {
  const EncoderDisturbance disturbance({.highest_frequency = 1e6}, 4);
  EncoderDisturbanceState state;
  EXPECT_EQ(disturbance.update(state, 15, 20e-6), 15);
  EXPECT_EQ(disturbance.update(state, 45, 20e-6), 35);
  EXPECT_EQ(disturbance.update(state, 40, 20e-6), 30);
}

}  // namespace
}  // namespace stator::plant
