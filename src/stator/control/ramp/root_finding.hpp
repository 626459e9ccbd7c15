#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace stator::control {

/// An argument of a function and its value there.
struct FunctionPoint {
  double x = 0.0;
  double y = 0.0;
};

/// Zero of the continuous `function` between `low` (y <= 0) and `high` (y >= 0), good to
/// |y| <= `tolerance` or to the resolution of x. Anderson and Björck's regula falsi, with a
/// bisection whenever it has brought less than as many bisections would.
template <typename Function>
[[nodiscard]] double root_between(FunctionPoint low, FunctionPoint high, double tolerance,
                                  const Function& function) {
  constexpr int kSteps = 64;
  constexpr int kLookEvery = 4;
  constexpr double kLeastGain = 16.0;  // of as many bisections
  double x = low.x;
  double y = high.y - low.y;
  double y_at_look = y;
  const FunctionPoint* kept_before = nullptr;
  for (int step = 1; step <= kSteps; ++step) {
    x = low.x - low.y * (high.x - low.x) / (high.y - low.y);
    bool bisect = !(x > low.x && x < high.x);
    if (step % kLookEvery == 0) {
      bisect = bisect || std::fabs(y) * kLeastGain > y_at_look;
      y_at_look = std::fabs(y);
    }
    if (bisect) {
      x = 0.5 * (low.x + high.x);
      if (!(x > low.x && x < high.x)) {
        break;  // neighbours
      }
    }
    y = function(x);
    if (std::fabs(y) <= tolerance) {
      return x;
    }
    FunctionPoint& replaced = y < 0.0 ? low : high;
    FunctionPoint& kept = y < 0.0 ? high : low;
    if (&kept == kept_before) {
      // The value at the end that stays is reduced, else that end would never move where the
      // function is curved.
      const double weight = 1.0 - y / replaced.y;
      kept.y *= weight > 0.0 ? weight : 0.5;
    }
    kept_before = &kept;
    replaced = {x, y};
  }
  return x;
}

/// A value of a function and its derivative.
struct ValueAndSlope {
  double value = 0.0;
  double slope = 0.0;
};

/// Zero between `low` and `high` of a `function` that rises and is convex: Newton's iteration,
/// which on such a function comes from one side after its first step and doubles its digits. Good
/// to `tolerance` or to the resolution of x.
template <typename Function>
[[nodiscard]] double convex_root(double low, double high, double guess, double tolerance,
                                 const Function& function) {
  constexpr int kSteps = 50;
  double x = guess < low ? low : guess < high ? guess : high;
  for (int step = 0; step < kSteps; ++step) {
    const ValueAndSlope here = function(x);
    if (std::fabs(here.value) <= tolerance) {
      break;
    }
    const double next = x - here.value / here.slope;
    const double inside = next < low ? low : next < high ? next : high;
    if (inside == x) {
      break;
    }
    x = inside;
  }
  return x;
}

/// Cube root of a number that is not negative, to a few units of the last place.
[[nodiscard]] inline double cube_root(double value) {
  if (!(value > 1e-300)) {
    return 0.0;
  }
  // A third of the exponent, and steps of Halley's iteration, each of which gives three times the
  // digits.
  constexpr std::uint64_t kBias = 0x2A9F7893782DA1CE;
  auto root = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) / 3 + kBias);
  for (int step = 0; step < 3; ++step) {
    const double cube = root * root * root;
    root *= (cube + 2.0 * value) / (2.0 * cube + value);
  }
  return root;
}

}  // namespace stator::control
