#include "stator/plant/sensors/analog_position_sensor.hpp"

#include <algorithm>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/mechanics/rotation.hpp"

namespace stator::plant {

std::array<std::uint16_t, 3> AnalogPositionSensor::read(const ElectricalAngle& angle,
                                                        base::Random& random) const {
  constexpr double kRounder = 0x1.8p52;
  std::array<std::uint16_t, 3> raw{};
  // Whole revolutions are whole periods of the scale.
  const std::int64_t period = angle.periods % pole_pairs_;
  const double shaft =
      (static_cast<double>(period) * base::kTwoPi + angle.angle) / static_cast<double>(pole_pairs_);
  const double scale = shaft * parameters_.periods_per_revolution;
  for (std::size_t k = 0; k < parameters_.tracks; ++k) {
    const AnalogTrack& track = parameters_.track[k];
    const base::SineCosine y = base::sine_cosine(scale + track.phase);
    const base::SineCosine twice = doubled(y);
    const double third = y.cosine * twice.cosine - y.sine * twice.sine;
    double counts =
        track.offset + track.amplitude * (y.cosine + track.second_harmonic * twice.cosine +
                                          track.third_harmonic * third);
    if (parameters_.noise > 0.0) {
      counts += parameters_.noise * random.bell();
    }
    raw[k] = static_cast<std::uint16_t>(std::clamp((counts + kRounder) - kRounder, 0.0, 65'535.0));
  }
  return raw;
}

}  // namespace stator::plant
