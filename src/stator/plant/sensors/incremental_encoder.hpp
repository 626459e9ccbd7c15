#pragma once

#include <cstdint>

#include "stator/plant/mechanics/shaft_angle.hpp"

namespace stator::plant {

/// An incremental encoder with A, B and N channels on the motor shaft.
struct EncoderParameters {
  std::int64_t counts_per_revolution = 40'000;  ///< after quadrature evaluation; 0 = none fitted
  bool reversed = false;                        ///< counts down when the shaft turns forward
  double offset =
      0.5;  ///< counts the disc is turned against the shaft; 0.5: full steps lie mid-count
  std::int64_t index_position =
      0;  ///< count within the revolution at which N is active (1 count wide)
  bool index_active_low = false;  ///< N is low at its pulse and high elsewhere
};

/// Absolute counts are those of the disc; the counter of a drive starts at 0 at power-on.
struct EncoderState {
  std::int64_t absolute = 0;         ///< count of the disc
  std::int64_t power_on = 0;         ///< `absolute` at power-on
  std::int64_t index_below = 0;      ///< absolute count of the N mark at or next below `absolute`
  std::int64_t latest_index = 0;     ///< absolute count of the N mark met last
  std::uint32_t index_passages = 0;  ///< N pulses met since power-on, modulo 2^32

  std::int64_t period = 0;            ///< electrical period for which the two values below hold
  std::int64_t period_base = 0;       ///< whole counts at its begin
  std::int64_t period_remainder = 0;  ///< and the rest in 1/p counts
};

/// Turns the shaft angle into counts. The whole part is integer arithmetic, hence exact after any
/// number of turns: absolute = floor((periods * cpr + cpr * angle / 2 pi) / p + offset).
class IncrementalEncoder {
 public:
  /// `pole_pairs` (p) relates electrical periods to revolutions.
  IncrementalEncoder(const EncoderParameters& parameters, std::int64_t pole_pairs);

  /// State of an encoder switched on with the shaft at `angle`.
  [[nodiscard]] EncoderState power_on(const ElectricalAngle& angle) const;
  /// Takes over a new shaft angle and notes the N pulses met on the way.
  void update(EncoderState& state, const ElectricalAngle& angle) const {
    const std::int64_t cpr = parameters_.counts_per_revolution;
    if (cpr <= 0) {
      return;
    }
    const std::int64_t before = state.absolute;
    state.absolute = locate(state, angle);
    const std::int64_t above = state.absolute - state.index_below;
    if (above <= 0 || above >= cpr) [[unlikely]] {
      meet_marks(state, before);
    }
  }

  /// Counts since power-on, with the direction of the disc.
  [[nodiscard]] std::int64_t count(const EncoderState& state) const {
    return directed(state.absolute - state.power_on);
  }
  /// The same at the N pulse met last.
  [[nodiscard]] std::int64_t index_count(const EncoderState& state) const {
    return directed(state.latest_index - state.power_on);
  }
  /// The disc has slipped back by so many counts since power-on.
  void set_slipped(double counts) { offset_ = parameters_.offset - counts; }
  [[nodiscard]] double counts_per_electrical_radian() const {
    return counts_per_revolution_ / (divisor_ * base::kTwoPi);
  }
  /// Level of the N channel.
  [[nodiscard]] bool index(const EncoderState& state) const {
    return parameters_.counts_per_revolution > 0 &&
           (state.absolute == state.index_below) != parameters_.index_active_low;
  }

 private:
  [[nodiscard]] std::int64_t directed(std::int64_t counts) const {
    return parameters_.reversed ? -counts : counts;
  }
  [[nodiscard]] std::int64_t locate(EncoderState& state, const ElectricalAngle& angle) const {
    if (angle.periods != state.period) [[unlikely]] {
      enter(state, angle.periods);
    }
    const double within = counts_per_revolution_ * (angle.angle * (1.0 / base::kTwoPi));
    const double counts =
        (static_cast<double>(state.period_remainder) + within) / divisor_ + offset_;
    const auto whole = static_cast<std::int64_t>(counts);
    return state.period_base + (counts < static_cast<double>(whole) ? whole - 1 : whole);
  }
  /// Begins an electrical period.
  void enter(EncoderState& state, std::int64_t period) const;
  /// Notes the N pulses between the count `before` and that of `state`.
  void meet_marks(EncoderState& state, std::int64_t before) const;

  EncoderParameters parameters_;
  std::int64_t pole_pairs_;
  double counts_per_revolution_;
  double divisor_;  ///< p
  double offset_;   ///< counts the disc is turned against the shaft, now
};

}  // namespace stator::plant
