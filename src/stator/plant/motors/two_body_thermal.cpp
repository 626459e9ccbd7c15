#include "stator/plant/motors/two_body_thermal.hpp"

#include <cmath>
#include <cstddef>

namespace stator::plant {

namespace {

using Matrix = std::array<std::array<double, 2>, 2>;

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result{};
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      result[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j];
    }
  }
  return result;
}

void add(Matrix& sum, const Matrix& term, double factor) {
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      sum[i][j] += factor * term[i][j];
    }
  }
}

/// exp(a) - 1 without loss of digits for a small `a`: Taylor series of a / 2^k, then k times
/// (1 + m)^2 - 1 = 2 m + m^2.
Matrix exponential_less_one(Matrix a) {
  constexpr double kSmall = 0.25;
  int doublings = 0;
  const auto largest = [&a] {
    return std::fmax(std::fabs(a[0][0]) + std::fabs(a[0][1]),
                     std::fabs(a[1][0]) + std::fabs(a[1][1]));
  };
  while (largest() > kSmall) {
    Matrix half{};
    add(half, a, 0.5);
    a = half;
    ++doublings;
  }
  Matrix sum = a;
  Matrix power = a;
  double factor = 1.0;
  for (int n = 2; n <= 12; ++n) {
    power = product(power, a);
    factor /= n;
    add(sum, power, factor);
  }
  for (; doublings > 0; --doublings) {
    const Matrix square = product(sum, sum);
    add(sum, sum, 1.0);
    add(sum, square, 1.0);
  }
  return sum;
}

}  // namespace

TwoBodyThermal::TwoBodyThermal(const ThermalParameters& parameters, double step)
    : inner_to_outer_(parameters.inner_to_outer), outer_to_ambient_(parameters.outer_to_ambient) {
  const double inner = step / parameters.inner_capacity;
  const double outer = step / parameters.outer_capacity;
  const double between = 1.0 / parameters.inner_to_outer;
  const double outside = 1.0 / parameters.outer_to_ambient;
  change_ = exponential_less_one(
      {{{-inner * between, inner * between}, {outer * between, -outer * (between + outside)}}});
}

}  // namespace stator::plant
