#pragma once

#include <array>
#include <cstdint>

#include "stator/base/random.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"
#include "stator/plant/sensors/incremental_encoder.hpp"

namespace stator::plant {

/// What is wrong with an incremental encoder and its cable.
struct EncoderFaults {
  bool lost = false;        ///< neither A nor B arrives: the count stands
  bool index_lost = false;  ///< N does not arrive
  /// A (1) or B (2) stands still: the edges of the other one count up and down in turn.
  std::uint8_t dead_channel = 0;
  /// Share of its way by which the disc stays behind the shaft: its coupling slips. 1 revolution
  /// per revolution and the disc stands; negative: it creeps ahead.
  double slip = 0.0;
  double slip_torque = 0.0;  ///< N m of the motor from which it slips; 0: always
  double noise = 0.0;        ///< counts by which a reading is off, at most, either way

  friend bool operator==(const EncoderFaults&, const EncoderFaults&) = default;
};

struct EncoderFaultState {
  EncoderState seen;          ///< the encoder at the end of the latest step
  ElectricalAngle angle;      ///< and the shaft
  double slipped = 0.0;       ///< counts the disc has slipped back since power-on
  base::Random random{8670};  ///< of the noise
};

/// Lets the drive miss `counts` counts forward (negative: see as many too much) from now on. What
/// its latch holds of the latest N pulse stays.
void lose_counts(const EncoderParameters& parameters, EncoderState& encoder, std::int64_t counts);

/// Notes where encoder and shaft are: what follows is spoiled.
void begin_faults(EncoderFaultState& state, const EncoderState& encoder,
                  const ElectricalAngle& angle);

/// Makes of `encoder`, which has followed the shaft to `angle`, what arrives at the drive. With the
/// motor's torque `torque` (N m).
void spoil(EncoderFaultState& state, const EncoderFaults& faults, IncrementalEncoder& disc,
           EncoderState& encoder, const ElectricalAngle& angle, double torque);

/// Counts by which the present reading is off.
[[nodiscard]] std::int64_t noise(EncoderFaultState& state, const EncoderFaults& faults);

}  // namespace stator::plant
