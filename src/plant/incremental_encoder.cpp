#include "plant/incremental_encoder.hpp"

namespace stator::plant {

namespace {

/// Quotient rounded down; `divisor` > 0.
std::int64_t floor_quotient(std::int64_t dividend, std::int64_t divisor) {
  const std::int64_t quotient = dividend / divisor;
  return dividend % divisor < 0 ? quotient - 1 : quotient;
}

}  // namespace

IncrementalEncoder::IncrementalEncoder(const EncoderParameters& parameters, std::int64_t pole_pairs)
    : parameters_(parameters), pole_pairs_(pole_pairs) {}

std::int64_t IncrementalEncoder::locate(EncoderState& state, const ElectricalAngle& angle) const {
  const std::int64_t cpr = parameters_.counts_per_revolution;
  if (angle.periods != state.period) {
    state.period = angle.periods;
    const std::int64_t total = angle.periods * cpr;
    state.period_base = floor_quotient(total, pole_pairs_);
    state.period_remainder = total - state.period_base * pole_pairs_;
  }
  const double within = static_cast<double>(cpr) * (angle.angle * (1.0 / base::kTwoPi));
  const double counts =
      (static_cast<double>(state.period_remainder) + within) / static_cast<double>(pole_pairs_) +
      parameters_.offset;
  const auto whole = static_cast<std::int64_t>(counts);
  return state.period_base + (counts < static_cast<double>(whole) ? whole - 1 : whole);
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

void IncrementalEncoder::update(EncoderState& state, const ElectricalAngle& angle) const {
  const std::int64_t cpr = parameters_.counts_per_revolution;
  if (cpr <= 0) {
    return;
  }
  const auto meet = [&state](std::int64_t mark) {
    state.latest_index = mark;
    ++state.index_passages;
  };
  const std::int64_t before = state.absolute;
  state.absolute = locate(state, angle);
  while (state.absolute >= state.index_below + cpr) {
    state.index_below += cpr;
    meet(state.index_below);
  }
  while (state.absolute < state.index_below) {
    if (before > state.index_below) {
      meet(state.index_below);
    }
    state.index_below -= cpr;
  }
  if (state.absolute == state.index_below && before > state.absolute) {
    meet(state.index_below);
  }
}

std::int64_t IncrementalEncoder::count(const EncoderState& state) const {
  const std::int64_t forward = state.absolute - state.power_on;
  return parameters_.reversed ? -forward : forward;
}

std::int64_t IncrementalEncoder::index_count(const EncoderState& state) const {
  const std::int64_t forward = state.latest_index - state.power_on;
  return parameters_.reversed ? -forward : forward;
}

bool IncrementalEncoder::index(const EncoderState& state) const {
  return parameters_.counts_per_revolution > 0 &&
         (state.absolute == state.index_below) != parameters_.index_active_low;
}

}  // namespace stator::plant
