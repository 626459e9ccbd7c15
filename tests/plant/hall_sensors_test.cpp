// Angles at which Hall sensors switch, with hysteresis, offset, misplacement and inversion.
#include "stator/plant/sensors/hall_sensors.hpp"

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

base::SineCosine at_degrees(double degrees) {
  return base::sine_cosine(degrees * base::kPi / 180.0);
}

TEST(HallSensors, ForwardTheSixCodesFollowEachOtherCentredEverySixtyDegrees) {
  const HallSensors halls({});
  constexpr std::array<unsigned, 6> kForward{1, 3, 2, 6, 4, 5};
  for (unsigned n = 0; n < 6; ++n) {
    for (const double off_centre : {-27.0, 0.0, 27.0}) {
      const auto levels = halls.power_on(at_degrees(60.0 * n + off_centre));
      EXPECT_EQ(halls.signal(levels), kForward[n]) << n << " " << off_centre;
    }
  }
}

/// Electrical degrees at which sensor `k` switches to high, turning by `direction` degrees a step.
double edge_to_high(const HallSensors& halls, unsigned k, double direction) {
  std::uint8_t levels = halls.power_on(at_degrees(180.0 + 120.0 * k));
  for (double degrees = 180.0 + 120.0 * k;; degrees += direction) {
    const std::uint8_t next = halls.next(levels, at_degrees(degrees));
    if ((next & ~levels & (1U << k)) != 0) {
      return degrees;
    }
    levels = next;
  }
}

TEST(HallSensors, SwitchWithHysteresisInTheDirectionOfTurn) {
  const HallSensors halls({.hysteresis = 5.0 * base::kPi / 180.0});
  EXPECT_NEAR(edge_to_high(halls, 0, 0.01), 270.0 + 5.0, 0.02);
  EXPECT_NEAR(edge_to_high(halls, 0, -0.01), 90.0 - 5.0, 0.02);
}

TEST(HallSensors, OffsetAndPlacementErrorsMoveTheEdges) {
  HallSensorParameters parameters{.offset = 20.0 * base::kPi / 180.0, .hysteresis = 0.0};
  parameters.placement_error[1] = 3.0 * base::kPi / 180.0;
  const HallSensors halls(parameters);
  EXPECT_NEAR(edge_to_high(halls, 0, 0.01), 290.0, 0.02);
  EXPECT_NEAR(edge_to_high(halls, 1, 0.01), 270.0 + 120.0 + 23.0, 0.02);
}

TEST(HallSensors, InvertedOnesReadTheOtherWayRoundAndMissingOnesLow) {
  EXPECT_EQ(HallSensors({.inverted = true}).signal(0b011), 0b100);
  EXPECT_EQ(HallSensors({.fitted = false}).signal(0b011), 0);
}

}  // namespace
}  // namespace stator::plant
