#pragma once

#include <cstdint>

#include "stator/control/foc/fixed_point.hpp"
#include "stator/control/foc/signals.hpp"

namespace stator::control::foc {

/// ABN_DECODER_MODE, PPR and offsets.
struct AbnSettings {
  bool a_inverted = false;
  bool b_inverted = false;
  bool n_inverted = false;
  bool use_abn = false;     ///< the N event is N and A and B
  bool write_back = false;  ///< an N event loads the counter from COUNT_N
  bool reversed = false;
  std::uint32_t ppr = 65536;  ///< positions per revolution, 4 per line; 0 counts as 1
  std::int32_t phi_m_offset = 0;
  std::int32_t phi_e_offset = 0;
  std::int32_t pole_pairs = 1;
};

/// Incremental encoder: a counter modulo PPR, its latch at the N event, and the angles
///   phi_m = count x 65536 / PPR + offset
///   phi_e = phi_m x NPP + offset                                        (L593-L623; A-39)
///
/// Both angles are exact integer arithmetic, rounded down. What is wired or set wrongly shows as it
/// does in reality: exactly one inverted channel reverses the direction, a wrong PPR makes angles
/// that do not close, and N and A and B never comes if N is narrower than the quadrant it misses.
class AbnDecoder {
 public:
  void configure(const AbnSettings& settings);

  /// Takes over what arrived since the last step.
  void step(const AbnSignals& signals) {
    n_event_ = false;
    if (signals.passages != input_.passages || !started_) [[unlikely]] {
      pass_index(signals);
    } else if (signals.count != input_.count) {
      turn(signals.count);
    }
    input_.n = signals.n;
  }

  /// The user writes the counter, modulo PPR.
  void set_count(std::uint32_t count) {
    count_ = count % settings_.ppr;
    update_angles();
  }
  /// The user writes the angle without offset, so that the counter follows.
  void set_angle(std::int32_t phi_m);
  void set_latch(std::uint32_t count) { latch_ = count; }

  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] std::uint32_t latch() const { return latch_; }  ///< COUNT_N
  [[nodiscard]] std::int32_t phi_m() const { return phi_m_; }   ///< s16
  [[nodiscard]] std::int32_t phi_e() const { return phi_e_; }   ///< s16
  [[nodiscard]] bool n_event() const { return n_event_; }       ///< in the latest step
  [[nodiscard]] const AbnSettings& settings() const { return settings_; }
  /// Levels of A, B, N at the pins: bits 0, 1, 2.
  [[nodiscard]] unsigned levels() const { return wire_levels(input_.count) | (input_.n ? 4U : 0U); }

 private:
  [[nodiscard]] static unsigned wire_levels(std::int64_t count) {
    const auto quadrant = static_cast<unsigned>(count) & 3U;
    return quadrant ^ (quadrant >> 1U);
  }
  /// The count at the pins has changed, and no N pulse was met.
  void turn(std::int64_t count) {
    const std::int64_t moved = count - input_.count;
    input_.count = count;
    count_by(reversed_ ? -moved : moved);
    update_angles();
  }
  /// An N pulse was met, or this is the first step.
  void pass_index(const AbnSignals& signals);
  /// Input count at which the N event of a passage lies; false if there is none.
  bool find_event(const AbnSignals& signals, bool forward, std::int64_t& where) const;
  [[nodiscard]] bool both_high(std::int64_t count) const;
  void count_by(std::int64_t steps) {
    const std::int64_t ppr = settings_.ppr;
    const std::int64_t count = count_ + steps;
    if (count >= ppr || count < 0) [[unlikely]] {
      wrap_count(count);
    } else {
      count_ = static_cast<std::uint32_t>(count);
    }
  }
  void wrap_count(std::int64_t count);
  void update_angles() {
    const std::uint64_t angle = exact_division_ ? exact_angle() : (count_ * reciprocal_) >> 47U;
    phi_m_ = wrap_s16(static_cast<std::int64_t>(angle) + settings_.phi_m_offset);
    phi_e_ = wrap_s16(std::int64_t{phi_m_} * settings_.pole_pairs + settings_.phi_e_offset);
  }
  [[nodiscard]] std::uint64_t exact_angle() const;

  AbnSettings settings_;
  std::uint64_t reciprocal_ = 1ULL << 47U;  ///< 2^63 / PPR, rounded up
  bool exact_division_ = false;             ///< PPR too large for the reciprocal
  bool reversed_ = false;                   ///< by its setting or by one inverted channel
  AbnSignals input_;
  bool started_ = false;  ///< the first step only learns where the counts stand
  std::uint32_t count_ = 0;
  std::uint32_t latch_ = 0;
  std::int32_t phi_m_ = 0;
  std::int32_t phi_e_ = 0;
  bool n_event_ = false;
};

}  // namespace stator::control::foc
