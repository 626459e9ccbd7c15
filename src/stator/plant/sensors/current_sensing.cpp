#include "stator/plant/sensors/current_sensing.hpp"

#include <algorithm>

namespace stator::plant {

namespace {

/// Nearest whole number, without a library call; |x| < 2^51.
double rounded(double x) {
  constexpr double kRounder = 0x1.8p52;
  return (x + kRounder) - kRounder;
}

}  // namespace

CurrentSensing::CurrentSensing(const CurrentSensingParameters& parameters)
    : parameters_(parameters),
      inverse_resolution_(parameters.resolution > 0.0 ? 1.0 / parameters.resolution : 0.0),
      exact_(parameters.gain == std::array{1.0, 1.0, 1.0} &&
             parameters.offset == std::array{0.0, 0.0, 0.0} && parameters.noise <= 0.0 &&
             parameters.resolution <= 0.0) {}

std::array<double, 3> CurrentSensing::measure(const std::array<double, 3>& current,
                                              base::Random& random) const {
  std::array<double, 3> result{};
  for (std::size_t k = 0; k < 3; ++k) {
    double value = parameters_.gain[k] * (current[k] + parameters_.offset[k]);
    if (noisy()) {
      value += parameters_.noise * random.bell();
    }
    value = std::clamp(value, -parameters_.range, parameters_.range);
    if (parameters_.resolution > 0.0) {
      value = rounded(value * inverse_resolution_) * parameters_.resolution;
    }
    result[k] = value;
  }
  return result;
}

}  // namespace stator::plant
