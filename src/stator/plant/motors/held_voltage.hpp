#pragma once

namespace stator::plant {

/// A winding without saliency that turns in the field of its magnets, over a step of h seconds with
/// the voltage u held in the stator frame. Its flux linkage, as a current phi = i + k z with
/// k = psi / L and z the direction of the magnets, knows no EMF:
///   dphi/dt = u / L - r phi + r k z,  r = R / L
/// z turns by x from z0 to z1; between them it is taken to turn evenly. Hence
///   i1 = decay i0 + gain u + (from_begin + P) z0 + (from_end + P) z1,  P = x^2 (square + x^2
///   fourth)
/// exact but for x^6 / 2000 of r h k.
struct HeldVoltage {
  double step = -1.0;               ///< h, s, for which the weights hold
  double series_resistance = -1.0;  ///< ohm of the transistors, part of R
  double rate = 0.0;                ///< r, 1/s
  double decay = 1.0;               ///< exp(-r h)
  double gain = 0.0;                ///< A/V
  double from_begin = 0.0;          ///< A
  double from_end = 0.0;            ///< A
  double square = 0.0;              ///< A/rad^2
  double fourth = 0.0;              ///< A/rad^4
  double yield = 0.0;               ///< A/rad; i1 loses so much ahead of z1 when z1 lies further on
  double lift = 0.0;                ///< A/rad^2; and gains along it times x

  // Mean over the step by values at its ends and their derivatives (Hermite):
  //   1/2 (y0 + y1) + h/12 (y0' - y1')
  // where the part -r i of the derivatives is added to the values.
  double mean_begin = 0.5;
  double mean_end = 0.5;
  double twelfth = 0.0;  ///< h / 12, s
  double quarter = 0.0;  ///< h / 4, s
  double bend = 0.0;     ///< h^3 / 24, s^3

  // Times a gain of speed (as w0 and the first torque promise it) that is spread evenly over the
  // step, and h: the mean quadrature current it costs.
  double opposition = 0.0;            ///< A s
  double opposition_by_direct = 0.0;  ///< s; times the direct current at the end
  double opposition_by_rise = 0.0;    ///< s^2; times its derivative there

  HeldVoltage() = default;
  /// `inductance` in H, `resistance` of winding and transistors in ohm, `flux_linkage` in V s;
  /// h R / L must not exceed 1.
  HeldVoltage(double step, double inductance, double resistance, double flux_linkage);
};

}  // namespace stator::plant
