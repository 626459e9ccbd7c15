#pragma once

#include <cstdint>
#include <limits>

#include "base/random.hpp"
#include "plant/shaft_angle.hpp"

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
      : parameters_(parameters), pole_pairs_(pole_pairs) {}

  /// The angle at which the disc seems to stand.
  [[nodiscard]] ElectricalAngle seen(const ElectricalAngle& angle) const;
  /// Takes over the encoder's count after `seconds`; the drive sees the result.
  std::int64_t update(EncoderDisturbanceState& state, std::int64_t count, double seconds) const;

 private:
  EncoderDisturbanceParameters parameters_;
  std::int64_t pole_pairs_;
};

}  // namespace stator::plant
