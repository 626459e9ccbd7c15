#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"

namespace stator::control::foc {

/// Coefficients in Q3.29 as the CONFIG registers hold them; 2^29 is 1.
struct BiquadCoefficients {
  std::int32_t a1 = 0;
  std::int32_t a2 = 0;
  std::int32_t b0 = std::int32_t{1} << 29;
  std::int32_t b1 = 0;
  std::int32_t b2 = 0;
  bool enabled = false;
};

/// Filter of second order on words of s32:
///   y(n) = b0 x(n) + b1 x(n-1) + b2 x(n-2) + a1 y(n-1) + a2 y(n-2)
///
/// What rounding takes from one output is added to the next, so that the gain at rest is exact and
/// the output comes to rest on the input if the coefficients say so. Disabled it passes its input
/// on. The output saturates to s32.
class Biquad {
 public:
  static constexpr int kFractionBits = 29;

  void configure(const BiquadCoefficients& coefficients) { c_ = coefficients; }
  [[nodiscard]] bool enabled() const { return c_.enabled; }

  std::int32_t step(std::int32_t x) { return c_.enabled ? filter(x) : x; }

  /// As if `x` had been there for ever and the gain at rest were 1.
  void preset(std::int32_t x) {
    x1_ = x2_ = y1_ = y2_ = x;
    remainder_ = 0;
  }

 private:
  std::int32_t filter(std::int32_t x);

  BiquadCoefficients c_;
  std::int32_t x1_ = 0;
  std::int32_t x2_ = 0;
  std::int32_t y1_ = 0;
  std::int32_t y2_ = 0;
  std::int64_t remainder_ = 0;  ///< of the latest rounding, in 2^-29
};

}  // namespace stator::control::foc
