#include "stator/mfc/units/encoder.hpp"

namespace stator::mfc {

namespace {

// ENC_MODE (L6448-L6536).
constexpr std::uint16_t kPolarityA = 1U << 0;
constexpr std::uint16_t kPolarityB = 1U << 1;
constexpr std::uint16_t kPolarityN = 1U << 2;
constexpr std::uint16_t kIgnoreAB = 1U << 3;
constexpr std::uint16_t kLatchAlways = 1U << 4;
constexpr std::uint16_t kLatchOnce = 1U << 5;
constexpr std::uint16_t kOnActive = 1U << 6;
constexpr std::uint16_t kOnInactive = 1U << 7;
constexpr std::uint16_t kClear = 1U << 8;
constexpr std::uint16_t kDecimal = 1U << 10;
constexpr std::uint16_t kAllBits = 0x07FF;

constexpr bool level_sensitive(std::uint16_t mode) {
  return (mode & (kOnActive | kOnInactive)) == 0;
}

}  // namespace

bool Encoder::Pair::settle() {
  bool now = positive;
  if (differential) {
    now = positive == negative ? level : positive;
  }
  const bool changed = now != level;
  level = now;
  return changed;
}

void Encoder::set_mapped(const SignalSet& mapped) {
  a_.differential = mapped.contains(Signal::an);
  b_.differential = mapped.contains(Signal::bn);
  n_.differential = mapped.contains(Signal::nn);
  n_has_pin_ = mapped.contains_any({Signal::n, Signal::nn});
  a_.settle();
  b_.settle();
  n_.settle();
  condition_ = event_condition();
}

Encoder::Pair& Encoder::pair_of(Signal signal) {
  if (signal == Signal::a || signal == Signal::an) {
    return a_;
  }
  return signal == Signal::b || signal == Signal::bn ? b_ : n_;
}

bool Encoder::put(Signal signal, bool level) {
  Pair& pair = pair_of(signal);
  const bool negative = signal == Signal::an || signal == Signal::bn || signal == Signal::nn;
  (negative ? pair.negative : pair.positive) = level;
  return pair.settle();
}

void Encoder::find(Signal signal, bool level) {
  static_cast<void>(put(signal, level));
  condition_ = event_condition();
}

void Encoder::input(base::SimTime time, Signal signal, bool level, SignalSink& sink) {
  if (!put(signal, level)) {
    return;
  }
  const Pair& pair = pair_of(signal);
  if (&pair == &a_) {
    count(a_.level != b_.level);
  } else if (&pair == &b_) {
    count(a_.level == b_.level);
  }
  update_event(time, sink);
}

/// The parts of a count are 1/unit; a constant, as dividing by others takes its time.
template <std::int64_t unit>
void Encoder::count_by(bool upwards) {
  const std::int64_t factor =
      std::int64_t{static_cast<std::int16_t>(constant_ >> 16)} * unit + (constant_ & 0xFFFF);
  const std::int64_t sum = std::int64_t{fraction_} + (upwards ? factor : -factor);
  std::int64_t whole = sum / unit;
  if (sum % unit < 0) {
    --whole;
  }
  position_ = static_cast<std::int32_t>(static_cast<std::uint32_t>(position_) +
                                        static_cast<std::uint32_t>(whole));
  fraction_ = static_cast<std::uint32_t>(sum - whole * unit);
}

void Encoder::count(bool upwards) {
  // Negative factors are stored with a positive fraction (L8999-L9013), so that integer part and
  // fraction only need adding.
  if ((mode_ & kDecimal) != 0) {
    count_by<10000>(upwards);
  } else {
    count_by<65536>(upwards);
  }
}

bool Encoder::event_condition() const {
  const bool n_active = n_has_pin_ && n_.level == ((mode_ & kPolarityN) != 0);
  const bool a_and_b_match =
      a_.level == ((mode_ & kPolarityA) != 0) && b_.level == ((mode_ & kPolarityB) != 0);
  return n_active && ((mode_ & kIgnoreAB) != 0 || a_and_b_match);
}

bool Encoder::event_goes_on() const {
  return condition_ && level_sensitive(mode_);
}

void Encoder::update_event(base::SimTime time, SignalSink& sink) {
  const bool before = condition_;
  condition_ = event_condition();
  const bool begins = condition_ && !before && (mode_ & kOnActive) != 0;
  const bool ends = !condition_ && before && (mode_ & kOnInactive) != 0;
  if (begins || ends || (condition_ && level_sensitive(mode_))) {
    n_event(time, sink);
  }
}

void Encoder::n_event(base::SimTime time, SignalSink& sink) {
  n_event_ = true;
  if ((mode_ & kLatchAlways) != 0 || once_armed_) {
    latch_ = position_;
    if ((mode_ & kClear) != 0) {
      write_position(0);
    }
    once_armed_ = false;
  }
  sink.interrupt(time, IrqSource::enc_n_event);
}

void Encoder::write_mode(base::SimTime time, std::uint16_t mode, SignalSink& sink) {
  if (((mode ^ mode_) & kDecimal) != 0) {
    fraction_ = 0;
  }
  mode_ = mode & kAllBits;
  once_armed_ = (mode_ & kLatchOnce) != 0;
  condition_ = event_condition();
  if (condition_ && level_sensitive(mode_)) {
    n_event(time, sink);
  }
}

void Encoder::write_position(std::int32_t position) {
  position_ = position;
  fraction_ = 0;
}

std::uint8_t Encoder::read_status() {
  const std::uint8_t value = status();
  n_event_ = event_goes_on();
  return value;
}

}  // namespace stator::mfc
