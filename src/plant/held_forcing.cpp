#include "plant/held_forcing.hpp"

#include <array>
#include <cstddef>

namespace stator::plant {

namespace {

/// Integrals from 0 to 1 of exp(-z (1 - x)) x^n for n = 0, 1, 2: the series
///   sum over k of (-z)^k n! / (n + k + 1)!
std::array<double, 3> moments(double z) {
  constexpr int kTerms = 14;  // below 1e-13 for z = 1
  std::array<double, 3> result{};
  std::array<double, 3> term{1.0, 1.0 / 2.0, 1.0 / 3.0};
  for (int k = 0; k < kTerms; ++k) {
    for (int n = 0; n < 3; ++n) {
      const auto index = static_cast<std::size_t>(n);
      result[index] += term[index];
      term[index] *= -z / (n + k + 2);
    }
  }
  return result;
}

}  // namespace

HeldForcing::HeldForcing(double of_step, double of_rate)
    : step(of_step),
      third(of_step / 3.0),
      sixth(of_step / 6.0),
      half_step(0.5 * of_step),
      half_square(0.5 * of_step * of_step),
      rate(of_rate) {
  const double z = step * rate;
  const std::array<double, 3> m = moments(z);
  decay = 1.0 - z * m[0];
  // The parabola's base: 2x^2 - 3x + 1, 4x - 4x^2, 2x^2 - x.
  whole[0] = step * (2.0 * m[2] - 3.0 * m[1] + m[0]);
  whole[1] = step * (4.0 * m[1] - 4.0 * m[2]);
  whole[2] = step * (2.0 * m[2] - m[1]);
  // The same with x = y / 2, y from 0 to 1.
  const std::array<double, 3> n = moments(0.5 * z);
  half_decay = 1.0 - 0.5 * z * n[0];
  half[0] = 0.5 * step * (0.5 * n[2] - 1.5 * n[1] + n[0]);
  half[1] = 0.5 * step * (2.0 * n[1] - n[2]);
  half[2] = 0.5 * step * (0.5 * n[2] - 0.5 * n[1]);
}

}  // namespace stator::plant
