#include "stator/plant/sensors/hall_sensors.hpp"

namespace stator::plant {

HallSensors::HallSensors(const HallSensorParameters& parameters)
    : threshold_{base::sine_cosine(parameters.hysteresis).sine,
                 -base::sine_cosine(parameters.hysteresis).sine},
      inversion_(parameters.inverted ? 7 : 0),
      mask_(parameters.fitted ? 7 : 0) {
  for (unsigned k = 0; k < 3; ++k) {
    axis_[k] = base::sine_cosine(k * (base::kTwoPi / 3.0) + parameters.offset +
                                 parameters.placement_error[k]);
  }
}

std::uint8_t HallSensors::power_on(const base::SineCosine& direction) const {
  unsigned result = 0;
  for (unsigned k = 0; k < 3; ++k) {
    const double seen = axis_[k].cosine * direction.cosine + axis_[k].sine * direction.sine;
    result |= static_cast<unsigned>(seen > 0.0) << k;
  }
  return static_cast<std::uint8_t>(result);
}

}  // namespace stator::plant
