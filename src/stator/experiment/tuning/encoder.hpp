#pragma once

#include <cstdint>

#include "stator/experiment/tuning/chip.hpp"
#include "stator/experiment/tuning/settings.hpp"

namespace stator::experiment::tuning {

/// What turning the field slowly through at least a revolution tells.
struct Encoder {
  std::int32_t pole_pairs = 0;
  std::int32_t resolution = 0;  ///< counts per revolution
  bool reversed = false;        ///< counts down while the field turns forward
  bool has_index = false;       ///< an N pulse once per revolution
  /// ABN_DECODER_PHI_E_OFFSET, 65536 per electrical revolution, for a counter that was 0 at
  /// power-on.
  Measured offset;
  /// The same for a counter that is 0 at the N pulse; only with has_index.
  double index_offset = 0.0;
};

/// Turns the field forward until two N pulses, or as far as any motor needs, then a revolution
/// forward and back. The rotor follows a little late; the mean of both ways is where it stands
/// without friction, and over the revolution cogging and eccentricity drop out. Sets the encoder's
/// registers and N_POLE_PAIRS. Throws TuningError: encoder_silent, shaft_blocked, encoder_reversed,
/// encoder_resolution, pole_pairs.
[[nodiscard]] Encoder measure_encoder(Chip& chip);

}  // namespace stator::experiment::tuning
