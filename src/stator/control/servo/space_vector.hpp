#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "stator/base/trigonometry.hpp"
#include "stator/control/pair.hpp"

namespace stator::control {

// Space vectors of three-phase quantities; amplitude-invariant: a symmetrical system with the
// amplitude a is a vector of length a.

inline constexpr double kInverseSqrt3 = 0.57735026918962576451;
inline constexpr double kHalfSqrt3 = 0.86602540378443864676;

/// Fixed to the stator: alpha along phase U, beta 90 electrical degrees ahead.
struct StatorVector {
  double alpha = 0.0;
  double beta = 0.0;
};

/// Turning with the rotor: d along its flux, q 90 electrical degrees ahead.
struct RotorVector {
  double d = 0.0;
  double q = 0.0;
};

/// Clarke transformation; a common part of the three (measurement offset) drops out.
[[nodiscard]] constexpr StatorVector clarke(const std::array<double, 3>& phase) {
  return {(2.0 * phase[0] - (phase[1] + phase[2])) * (1.0 / 3.0),
          (phase[1] - phase[2]) * kInverseSqrt3};
}

/// Park transformation at the angle with sine and cosine `angle`.
[[nodiscard]] constexpr RotorVector park(const StatorVector& v, const base::SineCosine& angle) {
  return {angle.cosine * v.alpha + angle.sine * v.beta,
          angle.cosine * v.beta - angle.sine * v.alpha};
}

[[nodiscard]] constexpr StatorVector inverse_park(const RotorVector& v,
                                                  const base::SineCosine& angle) {
  return {angle.cosine * v.d - angle.sine * v.q, angle.sine * v.d + angle.cosine * v.q};
}

/// The three phases of a vector; their sum is 0.
[[nodiscard]] constexpr std::array<double, 3> inverse_clarke(const StatorVector& v) {
  const double half = -0.5 * v.alpha;
  const double side = kHalfSqrt3 * v.beta;
  return {v.alpha, half + side, half - side};
}

/// Angle sum, for a vector that is turned further.
[[nodiscard]] constexpr base::SineCosine turned(const base::SineCosine& a,
                                                const base::SineCosine& b) {
  return {a.sine * b.cosine + a.cosine * b.sine, a.cosine * b.cosine - a.sine * b.sine};
}

/// Cuts |v| to `limit`; d has priority: q gets what is left, so that the flux stays controlled.
/// |v.d| must not exceed the limit. Returns whether q was cut.
inline bool limit_circle(RotorVector& v, double limit) {
  const double square = limit * limit - v.d * v.d;
  if (v.q * v.q <= square) {
    return false;
  }
  v.q = std::copysign(std::sqrt(std::max(square, 0.0)), v.q);
  return true;
}

/// Space-vector modulation: duties 0..1 of the three half bridges for the phase voltages of `v`
/// at a supply of 1 / `inverse_supply`, in the same unit, with the common part that centres them
/// (half of the sum of the largest and the smallest), hence linear up to |v| = supply / sqrt(3);
/// beyond it the result leaves 0..1. Duties are whole 4096ths, as of a 12-bit PWM timer.
[[nodiscard]] inline std::array<double, 3> space_vector_duties(const StatorVector& v,
                                                               double inverse_supply) {
  constexpr double kTimerSteps = 4096.0;
  constexpr double kRounder = 0x1.8p52;
  const std::array<double, 3> phase = inverse_clarke(v);
  const double centre = -0.5 * (std::max(std::max(phase[0], phase[1]), phase[2]) +
                                std::min(std::min(phase[0], phase[1]), phase[2]));
  const double scale = kTimerSteps * inverse_supply;
  const auto duty = [&](auto voltage) {
    const auto steps = 0.5 * kTimerSteps + (voltage + centre) * scale;
    return ((steps + kRounder) - kRounder) * (1.0 / kTimerSteps);
  };
  const Pair vw = duty(Pair{phase[1], phase[2]});
  return {duty(phase[0]), vw[0], vw[1]};
}

}  // namespace stator::control
