#include "stator/plant/sensors/encoder_disturbance.hpp"

#include "stator/base/trigonometry.hpp"

namespace stator::plant {

ElectricalAngle EncoderDisturbance::seen_off_centre(const ElectricalAngle& angle) const {
  const auto pole_pairs = static_cast<double>(pole_pairs_);
  const std::int64_t period = angle.periods % pole_pairs_;
  const double shaft = (static_cast<double>(period) * base::kTwoPi + angle.angle) / pole_pairs;
  const double error =
      parameters_.eccentricity * base::sine_cosine(shaft + parameters_.eccentricity_phase).sine;
  return turned(angle, error * pole_pairs);
}

void EncoderDisturbance::lose(EncoderDisturbanceState& state, std::int64_t change,
                              double seconds) const {
  const std::int64_t direction = change < 0 ? -1 : 1;
  const std::int64_t edges = change * direction;
  const double possible = parameters_.highest_frequency * seconds;
  std::int64_t unseen = 0;
  if (static_cast<double>(edges) > possible) {
    unseen = edges - static_cast<std::int64_t>(possible);
  }
  if (parameters_.missed_edge_probability > 0.0 || parameters_.extra_edge_probability > 0.0) {
    const std::int64_t seen = edges - unseen;
    for (std::int64_t n = 0; n < seen; ++n) {
      const double dice = state.random.uniform();
      if (dice < parameters_.missed_edge_probability) {
        ++unseen;
      } else if (dice >= 1.0 - parameters_.extra_edge_probability) {
        --unseen;
      }
    }
  }
  state.lost += direction * unseen;
}

}  // namespace stator::plant
