#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/mechanics/rotation.hpp"
#include "stator/plant/motors/three_phase_motor.hpp"

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
  /// Its mean on the way there.
  [[nodiscard]] double mean(double turned) const {
    return torque +
           turned * (0.5 * slope + turned * ((1.0 / 3.0) * square + turned * (0.25 * cube)));
  }
};

/// The harmonics of a motor's cogging torque.
class Cogging {
 public:
  /// What around() needs of one of them.
  struct Harmonic {
    int times = 1;  ///< of the direction, or of six times it
    bool of_six = false;
    double sine = 0.0;  ///< N m, factors of sine and cosine
    double cosine = 0.0;
    double order = 1.0;
    double half_square = 0.0;   ///< -order^2 / 2, torque into the square's coefficient
    double sixth_square = 0.0;  ///< -order^2 / 6, slope into the cube's
  };

  explicit Cogging(const std::array<CoggingHarmonic, 2>& harmonics) {
    for (const CoggingHarmonic& harmonic : harmonics) {
      if (harmonic.amplitude != 0.0) {
        const base::SineCosine phase = base::sine_cosine(harmonic.phase);
        const double order = harmonic.order;
        harmonics_[count_++] = {
            .times = harmonic.order % 6 == 0 ? harmonic.order / 6 : harmonic.order,
            .of_six = harmonic.order % 6 == 0,
            .sine = harmonic.amplitude * phase.cosine,
            .cosine = harmonic.amplitude * phase.sine,
            .order = order,
            .half_square = -0.5 * order * order,
            .sixth_square = -order * order / 6.0,
        };
        reach_ = std::min(reach_, 1.0 / order);
        stiffness_ += std::fabs(harmonic.amplitude * order);
      }
    }
  }

  /// Good while order times the angle turned is below 1 (error of a 24th at 1); reach() says how
  /// far that is.
  [[nodiscard]] NearbyCogging around(const base::SineCosine& direction) const {
    NearbyCogging nearby;
    // Most motors have an order of 6 or 12.
    const base::SineCosine six = doubled(tripled(direction));
    for (std::size_t n = 0; n < count_; ++n) {
      const Harmonic& harmonic = harmonics_[n];
      const base::SineCosine here = multiple(harmonic.of_six ? six : direction, harmonic.times);
      const double torque = harmonic.sine * here.sine + harmonic.cosine * here.cosine;
      const double slope =
          harmonic.order * (harmonic.sine * here.cosine - harmonic.cosine * here.sine);
      nearby.torque += torque;
      nearby.slope += slope;
      nearby.square += harmonic.half_square * torque;
      nearby.cube += harmonic.sixth_square * slope;
    }
    return nearby;
  }
  /// Electrical rad a step may turn for the polynomial to hold. At the speeds beyond, hundreds of
  /// teeth pass before the shaft follows any, and cogging may be left away.
  [[nodiscard]] double reach() const { return reach_; }

  [[nodiscard]] std::span<const Harmonic> harmonics() const { return {harmonics_.data(), count_}; }

  /// N m/rad by the electrical angle, at most.
  [[nodiscard]] double stiffness() const { return stiffness_; }

 private:
  std::array<Harmonic, 2> harmonics_{};
  std::size_t count_ = 0;
  double reach_ = 1.0;
  double stiffness_ = 0.0;
};

}  // namespace stator::plant
