#include "stator/plant/motors/held_voltage.hpp"

namespace stator::plant {

namespace {

/// Integrals from 0 to 1 of exp(-z (1 - x)) x^n.
struct Moments {
  double zeroth;
  double first;
  double second;
};

/// The second by its series, 1/3 (1 - z/4 (1 - z/5 (1 - ...))), the others by parts:
/// m[n - 1] = (1 - z m[n]) / n.
Moments moments(double z) {
  constexpr int kTerms = 14;  // below 1e-13 for z = 1
  double series = 1.0;
  for (int n = kTerms; n > 0; --n) {
    series = 1.0 - z * (1.0 / (n + 3)) * series;
  }
  Moments m{};
  m.second = (1.0 / 3.0) * series;
  m.first = (1.0 - z * m.second) * 0.5;
  m.zeroth = 1.0 - z * m.first;
  return m;
}

}  // namespace

HeldVoltage::HeldVoltage(double of_step, double inductance, double resistance, double flux_linkage)
    : step(of_step),
      twelfth(of_step / 12.0),
      quarter(0.25 * of_step),
      bend(of_step * of_step * of_step / 24.0),
      opposition_by_rise(0.5 * of_step * (of_step / 12.0)) {
  const double inverse_inductance = 1.0 / inductance;
  rate = resistance * inverse_inductance;
  const double z = step * rate;
  const double k = flux_linkage * inverse_inductance;
  const Moments m = moments(z);
  decay = 1.0 - z * m.zeroth;
  gain = step * inverse_inductance * m.zeroth;
  // z(s) = (sin(x (1 - s)) z0 + sin(x s) z1) / sin(x), by powers of x; beyond the first both ends
  // get the mean of their weights, which are less than 1 % of z apart.
  from_begin = k * (decay + z * (m.zeroth - m.first));
  from_end = k * (z * m.first - 1.0);
  square = k * z * (m.first - m.second) * 0.25;
  fourth = k * z * (1.0 / 240.0);
  yield = k * (1.0 - z * m.second);
  lift = k * z * (1.0 / 12.0);
  mean_begin = 0.5 - z * (1.0 / 12.0);
  const double end = 0.5 + z * (1.0 / 12.0);
  mean_end = end;
  // z1 lies further on by half of h times the gain; the current at the end falls by that times
  // `yield` and the direct current. The derivative falls by k and the direct current.
  opposition_by_direct = step * (0.5 * end - 1.0 / 12.0);
  opposition = step * (0.5 * end * yield - k * (1.0 / 12.0));
}

}  // namespace stator::plant
