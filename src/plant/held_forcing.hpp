#pragma once

#include <array>

namespace stator::plant {

/// Weights that solve di/dt = F(t) - r i over a step from the forcing at its begin, middle and
/// end, through which a parabola is laid:
///   i(h/2) = half_decay i(0) + half[0] F(0) + half[1] F(h/2) + half[2] F(h)
///   i(h)   = decay i(0) + whole[0] F(0) + whole[1] F(h/2) + whole[2] F(h)
/// Decay and the part of a constant forcing are exact; the parabola's error is of the order h^4 in
/// the middle and h^5 at the end.
struct HeldForcing {
  double step = -1.0;        ///< h, s, for which the weights hold
  double third = 0.0;        ///< h / 3
  double sixth = 0.0;        ///< h / 6
  double half_step = 0.0;    ///< h / 2
  double half_square = 0.0;  ///< h^2 / 2
  double rate = 0.0;         ///< r, 1/s
  double half_decay = 1.0;
  double decay = 1.0;
  std::array<double, 3> half{};   ///< s
  std::array<double, 3> whole{};  ///< s

  HeldForcing() = default;
  /// `step` * `rate` must not exceed 1.
  HeldForcing(double step, double rate);
};

}  // namespace stator::plant
