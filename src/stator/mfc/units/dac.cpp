#include "stator/mfc/units/dac.hpp"

#include "stator/mfc/units/clock.hpp"

namespace stator::mfc {

namespace {

constexpr std::int64_t kNumbers = 65536;

}  // namespace

std::uint16_t Dac::number(std::int64_t tick) {
  // Every step can be undone, so 65536 ticks in a row give 65536 different numbers.
  std::uint32_t x = static_cast<std::uint32_t>(tick) & 0xFFFF;
  x = (x + 0x9E37) & 0xFFFF;
  x ^= x >> 7;
  x = (x * 0x88B5) & 0xFFFF;
  x ^= x >> 9;
  x = (x * 0xDB2D) & 0xFFFF;
  x ^= x >> 8;
  return static_cast<std::uint16_t>(x);
}

std::int64_t Dac::next_change(std::int64_t tick) const {
  const bool level = level_at(tick);
  for (std::int64_t i = tick + 1; value_ != 0 && i <= tick + kNumbers; ++i) {
    if (level_at(i) != level) {
      return i;
    }
  }
  return Clock100MHz::kNever;
}

void Dac::advance(base::SimTime to, SignalSink& sink) {
  const std::int64_t end = Clock100MHz::last_tick(to);
  now_ = to;
  while (watched_ && next_change_ <= end) {
    const std::int64_t tick = next_change_;
    next_change_ = next_change(tick);
    sink.change(Clock100MHz::time_of(tick), Signal::dac0, level_at(tick));
  }
}

base::SimTime Dac::next_event() const {
  return watched_ ? Clock100MHz::time_of(next_change_) : base::SimTime::never();
}

void Dac::watch(const SignalSet& signals) {
  watched_ = signals.contains(Signal::dac0);
  if (watched_) {
    next_change_ = next_change(Clock100MHz::last_tick(now_));
  }
}

void Dac::write_value(std::uint16_t value, SignalSink& sink) {
  const bool before = level();
  value_ = value;
  if (watched_) {
    next_change_ = next_change(Clock100MHz::last_tick(now_));
    if (level() != before) {
      sink.change(now_, Signal::dac0, level());
    }
  }
}

bool Dac::level() const {
  return level_at(Clock100MHz::last_tick(now_));
}

}  // namespace stator::mfc
