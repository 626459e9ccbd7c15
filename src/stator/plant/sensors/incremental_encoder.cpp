#include "stator/plant/sensors/incremental_encoder.hpp"

namespace stator::plant {

namespace {

/// Quotient rounded down; `divisor` > 0.
std::int64_t floor_quotient(std::int64_t dividend, std::int64_t divisor) {
  const std::int64_t quotient = dividend / divisor;
  return dividend % divisor < 0 ? quotient - 1 : quotient;
}

/// `count` N pulses were met, the last one at the count `latest`.
void note_marks(EncoderState& state, std::int64_t count, std::int64_t latest) {
  if (count != 0) {
    state.latest_index = latest;
    state.index_passages += static_cast<std::uint32_t>(count);
  }
}

}  // namespace

IncrementalEncoder::IncrementalEncoder(const EncoderParameters& parameters, std::int64_t pole_pairs)
    : parameters_(parameters),
      pole_pairs_(pole_pairs),
      counts_per_revolution_(static_cast<double>(parameters.counts_per_revolution)),
      divisor_(static_cast<double>(pole_pairs)),
      offset_(parameters.offset) {}

void IncrementalEncoder::enter(EncoderState& state, std::int64_t period) const {
  const std::int64_t total = period * parameters_.counts_per_revolution;
  state.period = period;
  state.period_base = floor_quotient(total, pole_pairs_);
  state.period_remainder = total - state.period_base * pole_pairs_;
}

EncoderState IncrementalEncoder::power_on(const ElectricalAngle& angle) const {
  EncoderState state;
  const std::int64_t cpr = parameters_.counts_per_revolution;
  if (cpr > 0) {
    state.absolute = locate(state, angle);
    state.power_on = state.absolute;
    state.index_below = parameters_.index_position +
                        cpr * floor_quotient(state.absolute - parameters_.index_position, cpr);
    state.latest_index = state.power_on;
  }
  return state;
}

void IncrementalEncoder::meet_marks(EncoderState& state, std::int64_t before) const {
  const std::int64_t cpr = parameters_.counts_per_revolution;
  if (state.absolute > state.index_below) {
    const std::int64_t met = (state.absolute - state.index_below) / cpr;
    state.index_below += met * cpr;
    note_marks(state, met, state.index_below);
  } else if (state.absolute < state.index_below) {
    const std::int64_t left = (state.index_below - state.absolute - 1) / cpr + 1;
    // The one at or next below the count before has been met already where that stood on it.
    const std::int64_t met = before > state.index_below ? left : left - 1;
    note_marks(state, met, state.index_below - (left - 1) * cpr);
    state.index_below -= left * cpr;
  }
  if (state.absolute == state.index_below && before > state.absolute) {
    note_marks(state, 1, state.index_below);
  }
}

}  // namespace stator::plant
