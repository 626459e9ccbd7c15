#pragma once

#include <array>
#include <cstdint>

#include "stator/base/random.hpp"

namespace stator::plant {

/// Shunts, amplifiers and converter of the three phase currents. The defaults measure exactly.
struct CurrentSensingParameters {
  std::array<double, 3> gain{1.0, 1.0, 1.0};  ///< 1 = right
  std::array<double, 3> offset{};             ///< A
  double noise = 0.0;                         ///< A, standard deviation of a sample
  double resolution = 0.0;                    ///< A per step of the converter; 0: not quantised
  double range = 1e6;                         ///< A at which it saturates, either sign
};

/// Measures: range-limited, quantised gain * (current + offset) + noise.
class CurrentSensing {
 public:
  explicit CurrentSensing(const CurrentSensingParameters& parameters);

  /// Nothing falsifies the currents.
  [[nodiscard]] bool exact() const { return exact_; }
  /// Samples differ though the current does not.
  [[nodiscard]] bool noisy() const { return parameters_.noise > 0.0; }
  [[nodiscard]] std::array<double, 3> measure(const std::array<double, 3>& current,
                                              base::Random& random) const;

 private:
  CurrentSensingParameters parameters_;
  double inverse_resolution_;
  bool exact_;
};

}  // namespace stator::plant
