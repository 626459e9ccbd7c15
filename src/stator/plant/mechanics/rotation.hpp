#pragma once

#include "stator/base/trigonometry.hpp"

namespace stator::plant {

// Angles carried as sine and cosine through a step, without asking for either again.

/// Of the sum of two angles.
[[nodiscard]] constexpr base::SineCosine sum(const base::SineCosine& a, const base::SineCosine& b) {
  return {a.sine * b.cosine + a.cosine * b.sine, a.cosine * b.cosine - a.sine * b.sine};
}

/// Of a small angle, rad: error below 2e-10 for 0.33, 3e-13 for 0.17. The series are grouped so
/// that their terms can be computed side by side, for a step waits for nothing longer than for
/// this.
[[nodiscard]] constexpr base::SineCosine small_turn(double angle) {
  const double z = angle * angle;
  const double z2 = z * z;
  return {angle * ((1.0 - z * (1.0 / 6.0)) + z2 * (1.0 / 120.0 - z * (1.0 / 5040.0))),
          (1.0 - 0.5 * z) + z2 * ((1.0 / 24.0 - z * (1.0 / 720.0)) + z2 * (1.0 / 40320.0))};
}

/// `direction` turned by a small angle, rad.
[[nodiscard]] constexpr base::SineCosine rotated(const base::SineCosine& direction, double angle) {
  return sum(direction, small_turn(angle));
}

/// `direction` turned by a tiny angle, below 0.01 rad.
[[nodiscard]] constexpr base::SineCosine nudged(const base::SineCosine& direction, double angle) {
  const double z = angle * angle;
  return sum(direction, {angle * (1.0 - z * (1.0 / 6.0)), 1.0 - 0.5 * z});
}

/// Brought back to length 1, from which rounding took it by little.
[[nodiscard]] constexpr base::SineCosine normalised(const base::SineCosine& direction) {
  const double square = direction.sine * direction.sine + direction.cosine * direction.cosine;
  const double correction = 1.5 - 0.5 * square;
  return {direction.sine * correction, direction.cosine * correction};
}

/// Of twice the angle.
[[nodiscard]] constexpr base::SineCosine doubled(const base::SineCosine& a) {
  return {2.0 * (a.sine * a.cosine), a.cosine * a.cosine - a.sine * a.sine};
}

/// Of three times the angle.
[[nodiscard]] constexpr base::SineCosine tripled(const base::SineCosine& a) {
  const double square = 4.0 * (a.sine * a.sine);
  return {a.sine * (3.0 - square), a.cosine * (1.0 - square)};
}

/// Of `order` times the angle; order >= 1.
[[nodiscard]] constexpr base::SineCosine multiple(base::SineCosine direction, int order) {
  for (; (order & 1) == 0; order >>= 1) {
    direction = doubled(direction);
  }
  base::SineCosine result = direction;
  for (order >>= 1; order > 0; order >>= 1) {
    direction = doubled(direction);
    if ((order & 1) != 0) {
      result = sum(result, direction);
    }
  }
  return result;
}

}  // namespace stator::plant
