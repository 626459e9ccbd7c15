#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/random.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"

namespace stator::plant {

/// One track of an analog position sensor: raw = offset + amplitude (cos(y) + second cos(2y) +
/// third cos(3y)) + noise, y = N times the shaft angle + phase; rounded, clipped to 0..65535.
struct AnalogTrack {
  double amplitude = 20'000.0;   ///< counts
  double offset = 32'768.0;      ///< counts
  double phase = 0.0;            ///< rad
  double second_harmonic = 0.0;  ///< share of the amplitude
  double third_harmonic = 0.0;
};

/// Up to three tracks that see the same scale.
struct AnalogSensorParameters {
  int periods_per_revolution = 1;  ///< N
  std::size_t tracks = 0;          ///< 0: none fitted
  std::array<AnalogTrack, 3> track{};
  double noise = 0.0;  ///< counts, standard deviation of a sample
};

/// A sine/cosine encoder: cosine on track 0, sine on track 1.
[[nodiscard]] constexpr AnalogSensorParameters sine_cosine_encoder(int periods_per_revolution) {
  AnalogSensorParameters parameters{.periods_per_revolution = periods_per_revolution, .tracks = 2};
  parameters.track[1].phase = -0.5 * base::kPi;
  return parameters;
}

/// Analog Hall sensors of a motor: three tracks a third of an electrical period apart.
[[nodiscard]] constexpr AnalogSensorParameters analog_halls(int pole_pairs) {
  AnalogSensorParameters parameters{.periods_per_revolution = pole_pairs, .tracks = 3};
  parameters.track[1].phase = -base::kTwoPi / 3.0;
  parameters.track[2].phase = base::kTwoPi / 3.0;
  return parameters;
}

/// Raw values of the tracks. An error of the offset shows as an angle error once per period (1 % of
/// the amplitude: 0.57 degree), one of amplitude or phase twice per period (1 %: 0.29 degree).
class AnalogPositionSensor {
 public:
  /// `pole_pairs` relates electrical periods of the angle to revolutions.
  AnalogPositionSensor(const AnalogSensorParameters& parameters, std::int64_t pole_pairs)
      : parameters_(parameters), pole_pairs_(pole_pairs) {}

  [[nodiscard]] bool fitted() const { return parameters_.tracks > 0; }
  [[nodiscard]] std::array<std::uint16_t, 3> read(const ElectricalAngle& angle,
                                                  base::Random& random) const;

 private:
  AnalogSensorParameters parameters_;
  std::int64_t pole_pairs_;
};

}  // namespace stator::plant
