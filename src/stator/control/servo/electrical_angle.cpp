#include "stator/control/servo/electrical_angle.hpp"

#include <cstddef>

namespace stator::control {

namespace {

/// Taylor series of sine (first = 1) or cosine (first = 0) on 0 .. pi/4: the first term left out is
/// below 2^-60.
constexpr double series(double x, int first) {
  double term = first == 1 ? x : 1.0;
  double sum = 0.0;
  for (int n = first; n < 19; n += 2) {
    sum += term;
    term = -term * x * x / ((n + 1) * (n + 2));
  }
  return sum;
}

constexpr std::array<base::SineCosine, 256> sine_table() {
  constexpr std::size_t kQuarter = 64;
  std::array<base::SineCosine, 256> table{};
  for (std::size_t n = 0; n <= kQuarter / 2; ++n) {
    const double x = static_cast<double>(n) * (base::kTwoPi / 256.0);
    const double sine = series(x, 1);
    const double cosine = series(x, 0);
    table[n] = {sine, cosine};
    table[kQuarter - n] = {cosine, sine};
  }
  for (std::size_t n = kQuarter; n < table.size(); ++n) {
    table[n] = {table[n - kQuarter].cosine, -table[n - kQuarter].sine};
  }
  return table;
}

}  // namespace

constinit const std::array<base::SineCosine, 256> SineTable::entries = sine_table();

}  // namespace stator::control
