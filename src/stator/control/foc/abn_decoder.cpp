#include "stator/control/foc/abn_decoder.hpp"

namespace stator::control::foc {

void AbnDecoder::configure(const AbnSettings& settings) {
  settings_ = settings;
  if (settings_.ppr == 0) {
    settings_.ppr = 1;
  }
  // count < PPR, so the product of count and reciprocal stays below 2^63 + 2^24, and its error
  // below 2^-23 of an LSB: the quotient is exact while 1 / PPR is larger than that.
  constexpr std::uint32_t kExactBelow = 1U << 22U;
  exact_division_ = settings_.ppr >= kExactBelow;
  reversed_ = settings_.reversed != (settings_.a_inverted != settings_.b_inverted);
  reciprocal_ = ((1ULL << 63U) - 1) / settings_.ppr + 1;
  if (count_ >= settings_.ppr) {
    count_ %= settings_.ppr;
  }
  update_angles();
}

void AbnDecoder::set_angle(std::int32_t phi_m) {
  const std::uint64_t angle = static_cast<std::uint16_t>(phi_m - settings_.phi_m_offset);
  set_count(static_cast<std::uint32_t>((angle * settings_.ppr + 0x8000U) >> 16U));
}

std::uint64_t AbnDecoder::exact_angle() const {
  return (std::uint64_t{count_} << 16U) / settings_.ppr;
}

void AbnDecoder::wrap_count(std::int64_t count) {
  const std::int64_t ppr = settings_.ppr;
  count += count < 0 ? ppr : -ppr;
  if (count >= ppr || count < 0) {
    count %= ppr;
    count += count < 0 ? ppr : 0;
  }
  count_ = static_cast<std::uint32_t>(count);
}

bool AbnDecoder::both_high(std::int64_t count) const {
  const unsigned inverted = (settings_.a_inverted ? 1U : 0U) | (settings_.b_inverted ? 2U : 0U);
  return (wire_levels(count) ^ inverted) == 3U;
}

bool AbnDecoder::find_event(const AbnSignals& signals, bool forward, std::int64_t& where) const {
  const std::int64_t first = signals.n_count;
  const std::int64_t last = first + (signals.n_width > 0 ? signals.n_width - 1 : 0);
  const std::int64_t way = forward ? 1 : -1;
  if (!settings_.use_abn) {
    // An inverted N rises where the pulse ends.
    where = settings_.n_inverted ? (forward ? last + 1 : first - 1) : (forward ? first : last);
    return true;
  }
  if (settings_.n_inverted) {
    // High everywhere but at the pulse: any quadrant with A and B behind the pulse will do.
    where = forward ? last + 1 : first - 1;
    while (!both_high(where)) {
      where += way;
    }
    return true;
  }
  for (where = forward ? first : last; where >= first && where <= last; where += way) {
    if (both_high(where)) {
      return true;
    }
  }
  return false;
}

void AbnDecoder::pass_index(const AbnSignals& signals) {
  if (!started_) {
    started_ = true;
    input_ = signals;
    return;
  }
  const std::int64_t sign = reversed_ ? -1 : 1;
  const std::int64_t moved = signals.count - input_.count;
  input_ = signals;
  count_by(sign * moved);
  std::int64_t where = 0;
  if (find_event(signals, moved >= 0, where)) {
    n_event_ = true;
    const std::int64_t since = sign * (signals.count - where);
    if (settings_.write_back) {
      count_ = latch_ % settings_.ppr;
      count_by(since);
    } else {
      const std::uint32_t now = count_;
      count_by(-since);
      latch_ = count_;
      count_ = now;
    }
  }
  update_angles();
}

}  // namespace stator::control::foc
