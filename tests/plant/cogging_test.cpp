#include "stator/plant/motors/cogging.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

/// A sine of a sixfold order and one of another, shifted.
constexpr std::array<CoggingHarmonic, 2> kHarmonics{
    CoggingHarmonic{.order = 12, .amplitude = 3e-3},
    CoggingHarmonic{.order = 4, .amplitude = 2e-3, .phase = 0.7}};

double torque_at(double angle) {
  return 3e-3 * std::sin(12.0 * angle) + 2e-3 * std::sin(4.0 * angle + 0.7);
}

TEST(Cogging, IsTheSumOfItsHarmonicsEverywhere) {
  const Cogging cogging(kHarmonics);
  for (double angle = 0.0; angle < base::kTwoPi; angle += 0.01) {
    EXPECT_NEAR(cogging.around(base::sine_cosine(angle)).torque, torque_at(angle), 1e-15);
  }
}

TEST(Cogging, NearbyTorqueAndItsMeanFollowTheHarmonics) {
  const Cogging cogging(kHarmonics);
  constexpr double kTurned = 0.02;
  for (double angle = 0.0; angle < base::kTwoPi; angle += 0.1) {
    const NearbyCogging nearby = cogging.around(base::sine_cosine(angle));
    // What the polynomial leaves out: (12 * 0.02)^4 / 24 of the torque.
    EXPECT_NEAR(nearby.after(kTurned), torque_at(angle + kTurned), 1e-6);
    double sum = 0.0;
    for (int n = 0; n < 100; ++n) {
      sum += torque_at(angle + kTurned * (n + 0.5) / 100.0);
    }
    EXPECT_NEAR(nearby.mean(kTurned), sum / 100.0, 2e-7);
  }
}

}  // namespace
}  // namespace stator::plant
