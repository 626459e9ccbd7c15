#include "stator/plant/sensors/encoder_faults.hpp"

#include <cmath>

#include "stator/base/trigonometry.hpp"

namespace stator::plant {

namespace {

/// Level of channel A (1) or B (2) at a count: A leads, each is high for two of four counts.
std::int64_t level(std::int64_t count, int channel) {
  return ((channel == 1 ? count + 1 : count) >> 1) & 1;
}

/// The counter does not see `counts` of the disc's counts.
void hide(EncoderState& encoder, std::int64_t counts, bool keeps_latch) {
  encoder.power_on += counts;
  if (keeps_latch) {
    encoder.latest_index += counts;
  }
}

}  // namespace

void lose_counts(const EncoderParameters& parameters, EncoderState& encoder, std::int64_t counts) {
  hide(encoder, parameters.reversed ? -counts : counts, true);
}

void begin_faults(EncoderFaultState& state, const EncoderState& encoder,
                  const ElectricalAngle& angle) {
  state.seen = encoder;
  state.angle = angle;
}

void spoil(EncoderFaultState& state, const EncoderFaults& faults, IncrementalEncoder& disc,
           EncoderState& encoder, const ElectricalAngle& angle, double torque) {
  if (faults.slip != 0.0 && std::fabs(torque) >= faults.slip_torque) {
    const double way = static_cast<double>(angle.periods - state.angle.periods) * base::kTwoPi +
                       (angle.angle - state.angle.angle);
    state.slipped += faults.slip * way * disc.counts_per_electrical_radian();
    disc.set_slipped(state.slipped);
  }
  state.angle = angle;
  if (faults.index_lost) {
    encoder.index_passages = state.seen.index_passages;
    encoder.latest_index = state.seen.latest_index;
  }
  const std::int64_t change = encoder.absolute - state.seen.absolute;
  if (change != 0 && (faults.lost || faults.dead_channel != 0)) {
    // Edges of the intact channel count up and down in turn, since the dead channel never changes
    // its level.
    const std::int64_t seen = faults.lost ? 0
                                          : level(encoder.absolute, 3 - faults.dead_channel) -
                                                level(state.seen.absolute, 3 - faults.dead_channel);
    hide(encoder, change - seen, encoder.index_passages == state.seen.index_passages);
  }
  state.seen = encoder;
}

std::int64_t noise(EncoderFaultState& state, const EncoderFaults& faults) {
  if (faults.noise < 1.0) {
    return 0;
  }
  const auto most = static_cast<std::int64_t>(faults.noise);
  return static_cast<std::int64_t>(state.random.below(static_cast<std::uint64_t>(2 * most + 1))) -
         most;
}

}  // namespace stator::plant
