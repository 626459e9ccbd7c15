#include "stator/mfc/units/step_direction.hpp"

#include <algorithm>

#include "stator/mfc/units/clock.hpp"

namespace stator::mfc {

namespace {

// SD_CFG: eight bits per channel (L7166-L7244).
constexpr std::uint32_t kEnable = 1U << 0;
constexpr std::uint32_t kContinuous = 1U << 1;
constexpr std::uint32_t kStepPolarity = 1U << 2;
constexpr std::uint32_t kDirectionPolarity = 1U << 3;
constexpr std::uint32_t kClearCount = 1U << 4;
constexpr std::uint32_t kUseNextRate = 1U << 6;

constexpr std::uint32_t bits_of(std::uint32_t configuration, std::size_t channel) {
  return configuration >> (8 * channel);
}

/// S, D, Sn, Dn of a channel.
constexpr Signal step_signal(std::size_t channel) {
  return offset(Signal::s0, 2 * channel);
}
constexpr Signal direction_signal(std::size_t channel) {
  return offset(Signal::d0, 2 * channel);
}
constexpr Signal inverted_step_signal(std::size_t channel) {
  return offset(Signal::s0n, 2 * channel);
}
constexpr Signal inverted_direction_signal(std::size_t channel) {
  return offset(Signal::d0n, 2 * channel);
}

}  // namespace

std::int64_t StepDirection::tick() const {
  return emergency_ ? frozen_at_ : Clock25MHz::last_tick(now_) - frozen_ticks_;
}

base::SimTime StepDirection::time_of(std::int64_t channel_tick) const {
  return channel_tick >= Clock25MHz::kNever - frozen_ticks_
             ? base::SimTime::never()
             : Clock25MHz::time_of(channel_tick + frozen_ticks_);
}

StepDirection::Outputs StepDirection::outputs(std::size_t channel) const {
  const std::uint32_t bits = bits_of(configuration_, channel);
  return {.step = channels_[channel].pulse() != ((bits & kStepPolarity) != 0),
          .direction = channels_[channel].direction() != ((bits & kDirectionPolarity) != 0)};
}

bool StepDirection::level(Signal signal) const {
  const bool inverted = signal >= Signal::s0n;
  const auto index = static_cast<std::size_t>(signal) -
                     static_cast<std::size_t>(inverted ? Signal::s0n : Signal::s0);
  const Outputs now = emergency_ ? shown_[index / 2] : outputs(index / 2);
  return (index % 2 == 0 ? now.step : now.direction) != inverted;
}

void StepDirection::watch(const SignalSet& signals) {
  watched_signals_ = signals;
  for (std::size_t i = 0; i < kChannels; ++i) {
    watched_[i] = signals.contains_any({step_signal(i), inverted_step_signal(i)});
    if (!emergency_) {
      shown_[i] = outputs(i);
    }
  }
}

std::int64_t StepDirection::next_tick(std::size_t channel) const {
  const StepChannel& steps = channels_[channel];
  return watched_[channel] ? std::min(steps.next_edge(), steps.next_event()) : steps.next_event();
}

base::SimTime StepDirection::next_event() const {
  std::int64_t next = StepChannel::kNever;
  for (std::size_t i = 0; !emergency_ && i < kChannels; ++i) {
    const IrqSet sources = irq_bit(offset(IrqSource::sd0_target_reached, i)) |
                           irq_bit(offset(IrqSource::sd0_compare, i));
    const bool awaited =
        watched_[i] || (listened_ & sources) != 0 ||
        watched_signals_.contains_any({direction_signal(i), inverted_direction_signal(i)});
    if (awaited) {
      next = std::min(next, next_tick(i));
    }
  }
  return time_of(next);
}

void StepDirection::tell(std::size_t channel, base::SimTime time, SignalSink& sink) {
  if (emergency_) {
    return;
  }
  const Outputs now = outputs(channel);
  const auto tell_pair = [&](bool before, bool level, Signal signal, Signal inverted) {
    if (before == level) {
      return;
    }
    if (watched_signals_.contains(signal)) {
      sink.change(time, signal, level);
    }
    if (watched_signals_.contains(inverted)) {
      sink.change(time, inverted, !level);
    }
  };
  const Outputs before = shown_[channel];
  shown_[channel] = now;
  tell_pair(before.direction, now.direction, direction_signal(channel),
            inverted_direction_signal(channel));
  tell_pair(before.step, now.step, step_signal(channel), inverted_step_signal(channel));
}

void StepDirection::advance_channel(std::size_t channel, std::int64_t tick, SignalSink& sink) {
  const StepChannel::Event event = channels_[channel].advance(tick);
  tell(channel, time_of(tick), sink);
  if (event.target_reached) {
    sink.interrupt(time_of(event.tick), offset(IrqSource::sd0_target_reached, channel));
  }
  if (event.compare) {
    sink.interrupt(time_of(event.tick), offset(IrqSource::sd0_compare, channel));
  }
}

void StepDirection::advance(base::SimTime to, SignalSink& sink) {
  now_ = to;
  if (emergency_) {
    return;
  }
  const std::int64_t end = tick();
  while (true) {
    std::size_t first = 0;
    std::int64_t next = StepChannel::kNever;
    for (std::size_t i = 0; i < kChannels; ++i) {
      const std::int64_t candidate = next_tick(i);
      if (candidate < next) {
        first = i;
        next = candidate;
      }
    }
    if (next > end) {
      break;
    }
    advance_channel(first, next, sink);
  }
  for (std::size_t i = 0; i < kChannels; ++i) {
    channels_[i].advance(end);
    shown_[i] = outputs(i);
  }
}

void StepDirection::write_rate(std::size_t channel, std::int32_t rate, SignalSink& sink) {
  channels_[channel].write_rate(rate);
  tell(channel, now_, sink);
}

void StepDirection::write_target(std::size_t channel, std::uint32_t steps) {
  channels_[channel].write_target(steps);
}

void StepDirection::write_compare(std::size_t channel, std::int32_t compare) {
  channels_[channel].write_compare(compare);
}

void StepDirection::write_next_rate(std::size_t channel, std::int32_t rate) {
  channels_[channel].write_next_rate(rate);
}

void StepDirection::write_lengths(std::uint64_t lengths) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    channels_[i].write_length(static_cast<std::uint16_t>(lengths >> (16 * i)));
  }
}

void StepDirection::write_delays(std::uint64_t delays) {
  for (std::size_t i = 0; i < kChannels; ++i) {
    channels_[i].write_delay(static_cast<std::uint16_t>(delays >> (16 * i)));
  }
}

void StepDirection::write_configuration(std::uint32_t configuration, SignalSink& sink) {
  configuration_ = configuration & 0x00FF'FFFF;
  for (std::size_t i = 0; i < kChannels; ++i) {
    const std::uint32_t bits = bits_of(configuration_, i);
    channels_[i].write_configuration({.enable = (bits & kEnable) != 0,
                                      .continuous = (bits & kContinuous) != 0,
                                      .use_next_rate = (bits & kUseNextRate) != 0});
    if ((bits & kClearCount) != 0) {
      channels_[i].clear_count();
    }
    tell(i, now_, sink);
  }
}

void StepDirection::set_emergency(bool active, SignalSink& sink) {
  if (active == emergency_) {
    return;
  }
  if (active) {
    frozen_at_ = tick();
    emergency_ = true;
    return;
  }
  emergency_ = false;
  frozen_ticks_ = Clock25MHz::last_tick(now_) - frozen_at_;
  for (std::size_t i = 0; i < kChannels; ++i) {
    tell(i, now_, sink);
  }
}

void StepDirection::set_restart_on_new_rate(bool restart) {
  for (StepChannel& channel : channels_) {
    channel.set_restart_on_new_rate(restart);
  }
}

}  // namespace stator::mfc
