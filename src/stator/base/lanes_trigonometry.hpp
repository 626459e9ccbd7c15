#pragma once

#include <type_traits>

#include "stator/base/lanes.hpp"

namespace stator::base {

/// Sines and cosines of the lanes' angles.
template <typename L>
struct SineCosineLanes {
  typename L::Value sine;
  typename L::Value cosine;
};

/// sine_cosine() in lanes: of doubles the same bits; of floats an error below 1e-7. |angle| <= 1e6
/// (double), 1e3 (float).
template <typename L>
[[nodiscard]] [[gnu::always_inline]] inline SineCosineLanes<L> sine_cosine_lanes(
    const typename L::Value& angle) {
  using V = typename L::Value;
  using Number = typename ElementOf<V>::Type;
  const auto n = [](double x) { return static_cast<Number>(x); };
  const V quadrant = whole<V>(angle * n(0.63661977236758134308));
  V s;
  V c;
  if constexpr (std::is_same_v<Number, double>) {
    // As in trigonometry.cpp, where the constants are explained.
    const V x = (angle - quadrant * 0x1.921fb54400000p0) - quadrant * 0x1.0b4611a626331p-34;
    const V z = x * x;
    V p = z * (-1.0 / 1307674368000.0) + 1.0 / 6227020800.0;
    p = p * z - 1.0 / 39916800.0;
    p = p * z + 1.0 / 362880.0;
    p = p * z - 1.0 / 5040.0;
    p = p * z + 1.0 / 120.0;
    p = p * z - 1.0 / 6.0;
    s = x + x * z * p;
    p = z * (1.0 / 20922789888000.0) - 1.0 / 87178291200.0;
    p = p * z + 1.0 / 479001600.0;
    p = p * z - 1.0 / 3628800.0;
    p = p * z + 1.0 / 40320.0;
    p = p * z - 1.0 / 720.0;
    p = p * z + 1.0 / 24.0;
    c = (n(1.0) - n(0.5) * z) + z * z * p;
  } else {
    // Pi/2 in parts of 8 and 11 bits and the rest: their products with the quadrant are exact.
    constexpr double kHigh = 0x1.92p0;
    constexpr double kMiddle = 0x1.fb4p-12;
    constexpr double kLow = 1.57079632679489661923 - kHigh - kMiddle;
    const V x = ((angle - quadrant * n(kHigh)) - quadrant * n(kMiddle)) - quadrant * n(kLow);
    const V z = x * x;
    V p = z * n(1.0 / 362880.0) - n(1.0 / 5040.0);
    p = p * z + n(1.0 / 120.0);
    p = p * z - n(1.0 / 6.0);
    s = x + x * z * p;
    p = z * n(-1.0 / 3628800.0) + n(1.0 / 40320.0);
    p = p * z - n(1.0 / 720.0);
    p = p * z + n(1.0 / 24.0);
    c = (n(1.0) - n(0.5) * z) + z * z * p;
  }
  const V turns = quadrant - n(4.0) * whole_below<V>(quadrant * n(0.25));  // 0..3
  const V odd = turns - n(2.0) * whole_below<V>(turns * n(0.5));
  const V sine = select(odd > n(0.5), c, s);
  const V cosine = select(odd > n(0.5), s, c);
  const V shifted = turns - n(1.5);
  return {select(turns > n(1.5), -sine, sine), select(shifted * shifted < n(0.5), -cosine, cosine)};
}

}  // namespace stator::base
