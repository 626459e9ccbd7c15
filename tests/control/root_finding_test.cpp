// Cube roots, bracketed roots and the stopping distance, from which S-shaped ramps are planned.
#include "stator/control/ramp/root_finding.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/ramp/acceleration_pulse.hpp"

namespace stator::control {
namespace {

TEST(RootFinding, CubeRootsAreGoodToTheLastDigits) {
  EXPECT_EQ(cube_root(0.0), 0.0);
  base::Random random(61);
  for (int i = 0; i < 10'000; ++i) {
    const double value = std::pow(10.0, 60.0 * random.uniform() - 30.0);
    ASSERT_NEAR(cube_root(value), std::cbrt(value), 1e-15 * std::cbrt(value)) << value;
  }
}

TEST(RootFinding, FindsTheZeroOfACurveWithAFlatPart) {
  int calls = 0;
  const auto function = [&calls](double x) {
    ++calls;
    return x < 9.0 ? -0.5 : std::pow(x - 9.0, 3.0) - 0.5;
  };
  const double root = root_between({0.0, -0.5}, {10.0, 0.5}, 1e-12, function);
  EXPECT_NEAR(root, 9.0 + std::cbrt(0.5), 1e-11);
  EXPECT_LT(calls, 25);
}

TEST(RootFinding, NewtonsIterationStaysBetweenItsBounds) {
  const auto function = [](double x) { return ValueAndSlope{x * x * x - 8.0, 3.0 * x * x}; };
  for (const double guess : {-5.0, 0.1, 1.9, 2.0, 90.0, std::nan("")}) {
    EXPECT_NEAR(convex_root(0.1, 100.0, guess, 1e-12, function), 2.0, 1e-12) << guess;
  }
}

TEST(StoppingWay, IsTheWayOfThePulseThatStops) {
  base::Random random(62);
  for (int i = 0; i < 10'000; ++i) {
    const Slope slope(std::pow(10.0, 3.0 + 4.0 * random.uniform()),
                      std::pow(10.0, 3.0 + 6.0 * random.uniform()),
                      std::pow(10.0, 3.0 + 6.0 * random.uniform()));
    const StoppingWay way(slope);
    const double speed = std::pow(10.0, 6.0 * random.uniform());
    const double expected = AccelerationPulse::over(slope, 0.0, speed).way(speed, -1.0);
    ASSERT_NEAR(way(speed), expected, 1e-9 * expected) << "case " << i;
    const double step = 1e-4 * speed;
    ASSERT_NEAR(way.with_slope(speed).slope, (way(speed + step) - way(speed - step)) / (2.0 * step),
                1e-3 * way.with_slope(speed).slope)
        << "case " << i;
  }
}

}  // namespace
}  // namespace stator::control
