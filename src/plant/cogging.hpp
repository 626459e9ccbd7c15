#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/trigonometry.hpp"
#include "plant/rotation.hpp"
#include "plant/three_phase_motor.hpp"

namespace stator::plant {

/// The cogging torque around a place, as a polynomial of the electrical angle turned from there.
struct NearbyCogging {
  double torque = 0.0;  ///< N m, at the place
  double slope = 0.0;   ///< coefficients of the angle's powers
  double square = 0.0;
  double cube = 0.0;

  /// N m after `turned` electrical rad.
  [[nodiscard]] double after(double turned) const {
    return torque + turned * (slope + turned * (square + turned * cube));
  }
};

/// The harmonics of a motor's cogging torque.
class Cogging {
 public:
  explicit Cogging(const std::array<CoggingHarmonic, 2>& harmonics) {
    for (const CoggingHarmonic& harmonic : harmonics) {
      if (harmonic.amplitude != 0.0) {
        const double order = harmonic.order;
        harmonics_[count_++] = {
            .order = harmonic.order,
            .shifted = harmonic.phase != 0.0,
            .phase = base::sine_cosine(harmonic.phase),
            .torque = harmonic.amplitude,
            .slope = harmonic.amplitude * order,
            .square = -harmonic.amplitude * (order * order) / 2.0,
            .cube = -harmonic.amplitude * (order * order * order) / 6.0,
        };
        reach_ = std::min(reach_, 1.0 / order);
      }
    }
  }

  /// Good while order times the angle turned is below 1 (error of a 24th at 1); reach() says how
  /// far that is.
  [[nodiscard]] NearbyCogging around(const base::SineCosine& direction) const {
    NearbyCogging nearby;
    for (std::size_t n = 0; n < count_; ++n) {
      const Harmonic& harmonic = harmonics_[n];
      base::SineCosine here = multiple(direction, harmonic.order);
      here = harmonic.shifted ? sum(here, harmonic.phase) : here;
      nearby.torque += harmonic.torque * here.sine;
      nearby.slope += harmonic.slope * here.cosine;
      nearby.square += harmonic.square * here.sine;
      nearby.cube += harmonic.cube * here.cosine;
    }
    return nearby;
  }
  /// Electrical rad a step may turn for the polynomial to hold. At the speeds beyond, hundreds of
  /// teeth pass before the shaft follows any, and cogging may be left away.
  [[nodiscard]] double reach() const { return reach_; }

  /// N m/rad by the electrical angle, at most.
  [[nodiscard]] double stiffness() const {
    return std::fabs(harmonics_[0].slope) + std::fabs(harmonics_[1].slope);
  }

 private:
  struct Harmonic {
    int order = 1;
    bool shifted = false;
    base::SineCosine phase{0.0, 1.0};
    double torque = 0.0;  ///< N m, factors of sine and cosine
    double slope = 0.0;
    double square = 0.0;
    double cube = 0.0;
  };
  std::array<Harmonic, 2> harmonics_{};
  std::size_t count_ = 0;
  double reach_ = 1.0;
};

}  // namespace stator::plant
