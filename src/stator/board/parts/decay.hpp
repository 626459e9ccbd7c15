#pragma once

namespace stator::board {

/// exp(-x) for x >= 0 from additions, multiplications and divisions alone, so with the same bits
/// everywhere; relative error below 1e-12 up to x = 100, 0 beyond 700.
[[nodiscard]] constexpr double decay(double x) {
  constexpr double kSmall = 0.125;
  if (x > 700.0) {
    return 0.0;
  }
  int squarings = 0;
  while (x > kSmall) {
    x *= 0.5;
    ++squarings;
  }
  double term = 1.0;
  double sum = 1.0;
  for (int n = 1; n <= 10; ++n) {
    term *= -x / n;
    sum += term;
  }
  for (; squarings > 0; --squarings) {
    sum *= sum;
  }
  return sum;
}

}  // namespace stator::board
