#pragma once

#include <cstdint>
#include <limits>

#include "stator/base/random.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"

namespace stator::plant {

/// What makes an incremental encoder err.
struct EncoderDisturbanceParameters {
  /// Mechanical rad by which a disc that sits off its centre errs once per revolution.
  double eccentricity = 0.0;
  double eccentricity_phase = 0.0;       ///< rad
  double missed_edge_probability = 0.0;  ///< 0..1; an edge the counter does not see
  double extra_edge_probability = 0.0;   ///< 0..1; an edge it sees twice
  double highest_frequency = std::numeric_limits<double>::infinity();  ///< counts/s; beyond it
                                                                       ///< counts get lost
};

struct EncoderDisturbanceState {
  std::int64_t lost = 0;     ///< counts forward that the drive did not see
  std::int64_t counted = 0;  ///< of the encoder, at the latest update
  base::Random random{1};
};

/// Distorts what an encoder sees and what a drive sees of the encoder.
class EncoderDisturbance {
 public:
  /// `pole_pairs` relates electrical periods of the angle to revolutions.
  EncoderDisturbance(const EncoderDisturbanceParameters& parameters, std::int64_t pole_pairs)
      : parameters_(parameters),
        pole_pairs_(pole_pairs),
        may_lose_(parameters.missed_edge_probability > 0.0 ||
                  parameters.extra_edge_probability > 0.0 ||
                  parameters.highest_frequency < std::numeric_limits<double>::infinity()) {}

  /// The angle at which the disc seems to stand.
  [[nodiscard]] ElectricalAngle seen(const ElectricalAngle& angle) const {
    return parameters_.eccentricity == 0.0 ? angle : seen_off_centre(angle);
  }
  /// Takes over the encoder's count after `seconds`; the drive sees the result.
  std::int64_t update(EncoderDisturbanceState& state, std::int64_t count, double seconds) const {
    const std::int64_t change = count - state.counted;
    state.counted = count;
    if (change != 0 && may_lose_) {
      lose(state, change, seconds);
    }
    return count - state.lost;
  }

 private:
  [[nodiscard]] ElectricalAngle seen_off_centre(const ElectricalAngle& angle) const;
  void lose(EncoderDisturbanceState& state, std::int64_t change, double seconds) const;

  EncoderDisturbanceParameters parameters_;
  std::int64_t pole_pairs_;
  bool may_lose_;  ///< counts, one way or the other
};

}  // namespace stator::plant
