#include "stator/mfc/units/pwm.hpp"

#include <algorithm>
#include <bit>

#include "stator/mfc/units/clock.hpp"
#include "stator/mfc/units/pwm_geometry.hpp"

namespace stator::mfc {

namespace {

/// HS0 to LS3 have the codes 31 to 38, the pulses 72 to 76.
constexpr std::size_t output_of(Signal signal) {
  const auto code = static_cast<std::size_t>(signal);
  return signal < Signal::pulse_a ? code - static_cast<std::size_t>(Signal::hs0)
                                  : code - static_cast<std::size_t>(Signal::pulse_a) + 8;
}
constexpr Signal signal_of(std::size_t output) {
  return output < 8 ? offset(Signal::hs0, output) : offset(Signal::pulse_a, output - 8);
}
constexpr std::size_t lowest(std::uint32_t bits) {
  return static_cast<std::size_t>(std::countr_zero(bits));
}
constexpr IrqSource source_of(std::size_t mark) {
  return offset(IrqSource::pwm_zero_pulse, mark);
}

}  // namespace

void Pwm::refresh(std::int64_t tick) {
  for (std::size_t i = 0; i < kOutputs; ++i) {
    if ((watched_ >> i & 1U) != 0) {
      next_change_[i] = geometry_.next_change(i, tick);
    }
  }
  for (std::size_t i = 0; i < kMarks; ++i) {
    next_mark_[i] = geometry_.next_mark(i, tick);
  }
}

void Pwm::watch(const SignalSet& signals) {
  const std::int64_t tick = Clock100MHz::last_tick(now_);
  watched_ = 0;
  shown_ = 0;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    if (signals.contains(signal_of(i))) {
      watched_ |= 1U << i;
      shown_ |= (geometry_.output(i, tick) ? 1U : 0U) << i;
    }
  }
  refresh(tick);
}

void Pwm::listen(IrqSet sources) {
  listened_ = 0;
  for (std::size_t i = 0; i < kMarks; ++i) {
    if ((sources & irq_bit(source_of(i))) != 0) {
      listened_ |= 1U << i;
    }
  }
  refresh(Clock100MHz::last_tick(now_));
}

std::int64_t Pwm::next_tick(std::uint32_t marks) const {
  std::int64_t next = PwmGeometry::kNever;
  for (std::uint32_t rest = watched_; rest != 0; rest &= rest - 1) {
    next = std::min(next, next_change_[lowest(rest)]);
  }
  for (std::uint32_t rest = marks; rest != 0; rest &= rest - 1) {
    next = std::min(next, next_mark_[lowest(rest)]);
  }
  return next;
}

base::SimTime Pwm::next_event() const {
  return Clock100MHz::time_of(next_tick(listened_));
}

void Pwm::tell_outputs(base::SimTime time, std::int64_t tick, SignalSink& sink) {
  for (std::size_t i = 0; i < kOutputs; ++i) {
    const std::uint32_t bit = 1U << i;
    if ((watched_ & bit) == 0) {
      continue;
    }
    const bool level = geometry_.output(i, tick);
    if (level != ((shown_ & bit) != 0)) {
      shown_ ^= bit;
      sink.change(time, signal_of(i), level);
    }
  }
}

/// Makes what happens at `tick`; returns the marks of which it told.
std::uint32_t Pwm::make_tick(std::int64_t tick, std::uint32_t marks, SignalSink& sink) {
  const base::SimTime time = Clock100MHz::time_of(tick);
  for (std::uint32_t rest = watched_; rest != 0; rest &= rest - 1) {
    const std::size_t i = lowest(rest);
    if (next_change_[i] == tick) {
      shown_ ^= 1U << i;
      next_change_[i] = geometry_.next_change(i, tick);
      sink.change(time, signal_of(i), (shown_ >> i & 1U) != 0);
    }
  }
  std::uint32_t events = 0;
  for (std::uint32_t rest = marks; rest != 0; rest &= rest - 1) {
    const std::size_t i = lowest(rest);
    if (next_mark_[i] == tick) {
      events |= 1U << i;
      next_mark_[i] = tick + geometry_.counts();
      sink.interrupt(time, source_of(i));
    }
  }
  return events;
}

void Pwm::advance(base::SimTime to, SignalSink& sink) {
  const std::int64_t end = Clock100MHz::last_tick(to);
  now_ = to;
  // A mark nobody listens to comes once per advance(): its flag is set, that is all.
  std::uint32_t marks = kAllMarks;
  for (std::int64_t next = next_tick(marks); next <= end; next = next_tick(marks)) {
    marks &= listened_ | ~make_tick(next, marks, sink);
  }
  for (std::uint32_t rest = kAllMarks & ~marks; rest != 0; rest &= rest - 1) {
    std::int64_t& next = next_mark_[lowest(rest)];
    if (next <= end) {
      next += ((end - next) / geometry_.counts() + 1) * geometry_.counts();
    }
  }
}

template <typename Change>
void Pwm::reconfigure(SignalSink& sink, Change change) {
  const std::int64_t tick = Clock100MHz::last_tick(now_);
  PwmSettings settings = geometry_.settings();
  change(settings);
  geometry_.reconfigure(settings, tick);
  refresh(tick);
  tell_outputs(now_, tick, sink);
}

void Pwm::write_configuration(std::uint64_t configuration, SignalSink& sink) {
  reconfigure(sink, [&](PwmSettings& settings) { settings.configuration = configuration; });
}

void Pwm::write_duty(std::size_t channel, std::uint16_t duty, SignalSink& sink) {
  reconfigure(sink, [&](PwmSettings& settings) { settings.duty[channel] = duty & 0x0FFF; });
}

void Pwm::write_shift(std::size_t channel, std::uint16_t shift, SignalSink& sink) {
  reconfigure(sink, [&](PwmSettings& settings) { settings.shift[channel] = shift & 0x0FFF; });
}

void Pwm::write_marks(std::uint32_t marks, SignalSink& sink) {
  reconfigure(sink, [&](PwmSettings& settings) { settings.marks = marks & 0x0FFF'0FFF; });
}

void Pwm::write_pulse_length(std::uint8_t length, SignalSink& sink) {
  reconfigure(sink, [&](PwmSettings& settings) { settings.pulse_length = length; });
}

void Pwm::set_emergency(bool active, SignalSink& sink) {
  reconfigure(sink, [&](PwmSettings& settings) { settings.emergency = active; });
}

bool Pwm::level(Signal signal) const {
  return geometry_.output(output_of(signal), Clock100MHz::last_tick(now_));
}

base::SimDuration Pwm::period() const {
  return base::SimDuration(geometry_.counts() * Clock100MHz::kPeriod);
}

std::uint16_t Pwm::counter() const {
  return static_cast<std::uint16_t>(geometry_.phase(Clock100MHz::last_tick(now_)));
}

}  // namespace stator::mfc
