#include "stator/mfc/units/spi_master.hpp"

#include "stator/mfc/units/clock.hpp"

namespace stator::mfc {

namespace {

// SPI_CONF (L6657-L6701).
constexpr std::uint16_t kKeepSelected = 1U << 3;
constexpr std::uint16_t kLsbFirst = 1U << 4;
constexpr std::uint16_t kClockPhase = 1U << 5;
constexpr std::uint16_t kClockPolarity = 1U << 6;
constexpr std::uint16_t kSingleTrigger = 1U << 15;

/// SPI_CONF bits 10:8.
enum class Trigger : std::uint8_t { data, zero, center, a, b, a_or_b, reserved, single };

constexpr Trigger trigger_of(std::uint16_t configuration) {
  return static_cast<Trigger>(configuration >> 8 & 7U);
}
constexpr std::uint8_t line_of(std::uint16_t configuration) {
  return static_cast<std::uint8_t>(configuration & 3U);
}

/// The marks that start a transfer (A-72: trigger 5 is A or B, 6 never starts).
constexpr IrqSet marks_of(Trigger trigger) {
  switch (trigger) {
    case Trigger::zero:
      return irq_bit(IrqSource::pwm_zero_pulse);
    case Trigger::center:
      return irq_bit(IrqSource::pwm_center_pulse);
    case Trigger::a:
      return irq_bit(IrqSource::pwm_a_pulse);
    case Trigger::b:
      return irq_bit(IrqSource::pwm_b_pulse);
    case Trigger::a_or_b:
      return irq_bit(IrqSource::pwm_a_pulse) | irq_bit(IrqSource::pwm_b_pulse);
    default:
      return 0;
  }
}

constexpr std::uint64_t lowest(std::uint64_t value, unsigned bits) {
  return bits == 64 ? value : value & ((std::uint64_t{1} << bits) - 1);
}
constexpr std::uint64_t reversed(std::uint64_t value, unsigned bits) {
  std::uint64_t result = 0;
  for (unsigned i = 0; i < bits; ++i) {
    result |= (value >> i & 1U) << (bits - 1 - i);
  }
  return result;
}
/// Bit `index` in order of the wire.
constexpr bool wire_bit(std::uint64_t value, unsigned bits, unsigned index) {
  return (value >> (bits - 1 - index) & 1U) != 0;
}

}  // namespace

std::int64_t SpiMaster::edge_tick(int edge) const {
  return start_tick_ + half_ * (edge + 1);
}

bool SpiMaster::edges_watched() const {
  return watched_.contains_any({Signal::sck, Signal::sdo, Signal::sdi});
}

base::SimTime SpiMaster::next_event() const {
  if (!busy_) {
    return base::SimTime::never();
  }
  return Clock25MHz::time_of(edge_tick(edges_watched() ? edge_ : 2 * transfer_.bits));
}

bool SpiMaster::level(Signal signal) const {
  switch (signal) {
    case Signal::sck:
      return sck_;
    case Signal::sdo:
      return sdo_;
    case Signal::sdi:
      return selected_ && slaves_[selected_line_] != nullptr ? sdi_ : input_;
    default:
      return !selected_ || offset(Signal::cs0, selected_line_) != signal;
  }
}

void SpiMaster::set(base::SimTime time, Signal signal, bool level, SignalSink& sink) {
  bool& now = signal == Signal::sck ? sck_ : signal == Signal::sdo ? sdo_ : sdi_;
  if (now != level) {
    now = level;
    if (watched_.contains(signal)) {
      sink.change(time, signal, level);
    }
  }
}

void SpiMaster::select(SignalSink& sink) {
  const std::uint8_t line = line_of(configuration_);
  if (selected_ && selected_line_ != line) {
    deselect(now_, sink);
  }
  if (!selected_) {
    selected_ = true;
    selected_line_ = line;
    if (watched_.contains(offset(Signal::cs0, line))) {
      sink.change(now_, offset(Signal::cs0, line), false);
    }
    if (slaves_[line] != nullptr) {
      slaves_[line]->select(now_);
    }
  }
}

void SpiMaster::deselect(base::SimTime time, SignalSink& sink) {
  selected_ = false;
  if (watched_.contains(offset(Signal::cs0, selected_line_))) {
    sink.change(time, offset(Signal::cs0, selected_line_), true);
  }
  if (slaves_[selected_line_] != nullptr) {
    slaves_[selected_line_]->deselect(time);
  }
}

void SpiMaster::start(SignalSink& sink) {
  if (busy_) {
    return;
  }
  busy_ = true;
  in_force_ = configuration_;
  start_tick_ = Clock25MHz::last_tick(now_);
  half_ = 2 + std::int64_t{time_};
  edge_ = 0;
  sampled_ = 0;
  const auto bits = static_cast<std::uint8_t>((length_ & 0x3F) + 1);
  const std::uint64_t data = lowest(data_, bits);
  transfer_ = {.start = now_,
               .clock_period = base::SimDuration(2 * half_ * Clock25MHz::kPeriod),
               .bits = bits,
               .clock_polarity = (in_force_ & kClockPolarity) != 0,
               .clock_phase = (in_force_ & kClockPhase) != 0,
               .sent = (in_force_ & kLsbFirst) != 0 ? reversed(data, bits) : data};
  select(sink);
  SpiSlave* slave = slaves_[selected_line_];
  reply_ = slave != nullptr ? slave->exchange(transfer_) : 0;
  if (!transfer_.clock_phase) {
    put_bit(now_, 0, sink);
  }
}

void SpiMaster::put_bit(base::SimTime time, unsigned index, SignalSink& sink) {
  if (index >= transfer_.bits) {
    return;
  }
  set(time, Signal::sdo, wire_bit(transfer_.sent, transfer_.bits, index), sink);
  if (slaves_[selected_line_] != nullptr) {
    set(time, Signal::sdi, wire_bit(reply_, transfer_.bits, index), sink);
  }
}

void SpiMaster::make_edge(SignalSink& sink) {
  const base::SimTime time = Clock25MHz::time_of(edge_tick(edge_));
  const bool leading = edge_ % 2 == 0;
  set(time, Signal::sck, transfer_.clock_polarity == !leading, sink);
  if (leading != transfer_.clock_phase) {
    const bool bit = slaves_[selected_line_] != nullptr ? sdi_ : input_;
    sampled_ = sampled_ << 1 | (bit ? 1U : 0U);
  } else {
    const int index = transfer_.clock_phase ? edge_ / 2 : edge_ / 2 + 1;
    put_bit(time, static_cast<unsigned>(index), sink);
  }
  ++edge_;
}

void SpiMaster::finish(SignalSink& sink) {
  const base::SimTime time = Clock25MHz::time_of(edge_tick(edge_));
  busy_ = false;
  received_ = (in_force_ & kLsbFirst) != 0 ? reversed(sampled_, transfer_.bits) : sampled_;
  if ((in_force_ & kKeepSelected) == 0) {
    deselect(time, sink);
  }
  set(time, Signal::sck, (configuration_ & kClockPolarity) != 0, sink);
  sink.interrupt(time, IrqSource::spi_new_data);
}

/// What all edges of a transfer together leave behind.
void SpiMaster::pass_edges_unseen() {
  const unsigned bits = transfer_.bits;
  sampled_ = bits < 64 ? reply_ & ((std::uint64_t{1} << bits) - 1) : reply_;
  sck_ = transfer_.clock_polarity;
  sdo_ = (transfer_.sent & 1U) != 0;
  sdi_ = (reply_ & 1U) != 0;
  edge_ = 2 * transfer_.bits;
}

void SpiMaster::advance(base::SimTime to, SignalSink& sink) {
  now_ = to;
  const std::int64_t end = Clock25MHz::last_tick(to);
  if (busy_ && edge_ == 0 && !edges_watched() && slaves_[selected_line_] != nullptr &&
      edge_tick(2 * transfer_.bits) <= end) {
    pass_edges_unseen();
  }
  while (busy_ && edge_tick(edge_) <= end) {
    if (edge_ < 2 * transfer_.bits) {
      make_edge(sink);
    } else {
      finish(sink);
    }
  }
}

void SpiMaster::write_data(std::uint64_t data, bool complete, SignalSink& sink) {
  data_ = data;
  if (complete && trigger_of(configuration_) == Trigger::data) {
    start(sink);
  }
}

void SpiMaster::write_configuration(std::uint16_t configuration, SignalSink& sink) {
  configuration_ = configuration;
  marks_ = marks_of(trigger_of(configuration));
  if (!busy_) {
    set(now_, Signal::sck, (configuration & kClockPolarity) != 0, sink);
  }
  if (trigger_of(configuration) == Trigger::single && (configuration & kSingleTrigger) != 0) {
    start(sink);
  }
}

void SpiMaster::pwm_mark(IrqSource mark, SignalSink& sink) {
  if ((awaited_marks() & irq_bit(mark)) != 0) {
    start(sink);
  }
}

}  // namespace stator::mfc
