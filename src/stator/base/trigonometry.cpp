#include "stator/base/trigonometry.hpp"

#include <cstdint>

namespace stator::base {

namespace {

// Pi/2 split so that n * kHalfPiHigh is exact for |n| < 2^20 (Cody and Waite, "Software Manual for
// the Elementary Functions", chapter 8).
constexpr double kHalfPiHigh = 0x1.921fb54400000p0;
constexpr double kHalfPiLow = 0x1.0b4611a626331p-34;
constexpr double kTwoOverPi = 0.63661977236758134308;

// Taylor coefficients; on |x| <= pi/4 the first term left out is below 2^-54.
double sine_on_octant(double x) {
  const double z = x * x;
  double p = -1.0 / 1307674368000.0;
  p = p * z + 1.0 / 6227020800.0;
  p = p * z - 1.0 / 39916800.0;
  p = p * z + 1.0 / 362880.0;
  p = p * z - 1.0 / 5040.0;
  p = p * z + 1.0 / 120.0;
  p = p * z - 1.0 / 6.0;
  return x + x * z * p;
}

double cosine_on_octant(double x) {
  const double z = x * x;
  double p = 1.0 / 20922789888000.0;
  p = p * z - 1.0 / 87178291200.0;
  p = p * z + 1.0 / 479001600.0;
  p = p * z - 1.0 / 3628800.0;
  p = p * z + 1.0 / 40320.0;
  p = p * z - 1.0 / 720.0;
  p = p * z + 1.0 / 24.0;
  return (1.0 - 0.5 * z) + z * z * p;
}

/// Arc tangent of x, 0 <= x <= 1.
double arc_tangent_on_unit(double x) {
  // atan(x) = pi/4 + atan((x - 1) / (x + 1)) keeps the argument of the series below tan(pi/8),
  // where 20 terms reach 1e-17.
  constexpr double kTangentOfEighth = 0.41421356237309504880;
  const bool upper = x > kTangentOfEighth;
  const double t = upper ? (x - 1.0) / (x + 1.0) : x;
  const double z = t * t;
  double p = 0.0;
  for (int n = 39; n >= 3; n -= 2) {
    p = 1.0 / n - z * p;
  }
  return (upper ? 0.25 * kPi : 0.0) + (t - t * z * p);
}

}  // namespace

SineCosine sine_cosine(double angle) {
  // Adding and subtracting 1.5 * 2^52 rounds to the nearest integer without a library call.
  constexpr double kRounder = 0x1.8p52;
  const double quadrant = (angle * kTwoOverPi + kRounder) - kRounder;
  const double x = (angle - quadrant * kHalfPiHigh) - quadrant * kHalfPiLow;
  const double s = sine_on_octant(x);
  const double c = cosine_on_octant(x);
  switch (static_cast<std::int64_t>(quadrant) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double arc_tangent(double y, double x) {
  const double magnitude_x = x < 0.0 ? -x : x;
  const double magnitude_y = y < 0.0 ? -y : y;
  const bool steep = magnitude_y > magnitude_x;
  const double larger = steep ? magnitude_y : magnitude_x;
  if (larger == 0.0) {
    return 0.0;
  }
  const double ratio = (steep ? magnitude_x : magnitude_y) / larger;
  double angle = arc_tangent_on_unit(ratio);
  angle = steep ? 0.5 * kPi - angle : angle;
  angle = x < 0.0 ? kPi - angle : angle;
  return y < 0.0 ? -angle : angle;
}

}  // namespace stator::base
