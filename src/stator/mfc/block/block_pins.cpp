// Between the units of the I/O block and its pads.

#include <bit>
#include <utility>

#include "stator/mfc/block/block.hpp"

namespace stator::mfc {

namespace {

constexpr bool within(Signal signal, Signal first, Signal last) {
  return signal >= first && signal <= last;
}
constexpr std::size_t index_from(Signal signal, Signal first) {
  return static_cast<std::size_t>(signal) - static_cast<std::size_t>(first);
}
constexpr bool is_general_purpose_output(Signal signal) {
  return within(signal, Signal::gpo0, Signal::gpo15);
}
constexpr bool is_encoder_input(Signal signal) {
  return within(signal, Signal::a, Signal::nn);
}
constexpr bool is_open_drain(Signal signal) {
  return signal == Signal::scl || signal == Signal::sda;
}

/// Calls `visit(line)` for each line of the set.
template <typename Visitor>
void for_each_line(LineSet lines, Visitor visit) {
  for (; lines != 0; lines &= lines - 1) {
    visit(static_cast<std::size_t>(std::countr_zero(lines)));
  }
}

void put(SignalSet& set, Signal signal, bool in) {
  if (in) {
    set.insert(signal);
  } else {
    set.erase(signal);
  }
}

/// Whether something outside holds a line low.
bool held_low(const Pads& pads, std::size_t line) {
  return pads.short_at(line) == Short::to_ground ||
         pads.outside(line).kind == OutsideDrive::Kind::low;
}

}  // namespace

bool Block::unit_level(Signal signal) const {
  if (within(signal, Signal::sck, Signal::cs3)) {
    return spi_.level(signal);
  }
  if (is_open_drain(signal)) {
    return i2c_.level(signal);
  }
  if (within(signal, Signal::s0, Signal::d2n)) {
    return steps_.level(signal);
  }
  if (within(signal, Signal::hs0, Signal::ls3) ||
      within(signal, Signal::pulse_a, Signal::pulse_z)) {
    return pwm_.level(signal);
  }
  if (is_general_purpose_output(signal)) {
    return gpio_.level(index_from(signal, Signal::gpo0));
  }
  return signal == Signal::dac0 ? dac_.level() : signal == Signal::high;
}

void Block::fetch(Signal signal) {
  put(levels_, signal, unit_level(signal));
  if (is_general_purpose_output(signal)) {
    put(drivens_, signal, gpio_.driven(index_from(signal, Signal::gpo0)));
  }
}

PinCommand Block::command(std::size_t line) const {
  const bool high_voltage = line >= kFirstHighVoltage;
  if (overheated_ && high_voltage) {
    return {};
  }
  if ((action_.lines & line_bit(line)) != 0) {
    return {(action_.enables & line_bit(line)) != 0, (action_.levels & line_bit(line)) != 0};
  }
  const Signal signal = crossbar_.signal(line);
  if (!outputs_enabled() || !is_output(signal)) {
    return {};
  }
  const bool level = levels_.contains(signal);
  if (is_open_drain(signal)) {
    return {!level, false};
  }
  return {!is_general_purpose_output(signal) || drivens_.contains(signal), level};
}

void Block::update_lines(LineSet lines) {
  untold_ |= lines;
  for_each_line(lines, [this](std::size_t line) { pads_.command(line, command(line)); });
}

void Block::change(base::SimTime /*time*/, Signal signal, bool level) {
  put(levels_, signal, level);
  update_lines(crossbar_.lines(signal));
}

void Block::enable(base::SimTime /*time*/, Signal signal, bool driven) {
  put(drivens_, signal, driven);
  update_lines(crossbar_.lines(signal));
}

void Block::bring_pins_up_to_date() {
  advance_units();
  for (std::size_t line = 0; line < kLines; ++line) {
    if (is_output(crossbar_.signal(line))) {
      fetch(crossbar_.signal(line));
    }
  }
  update_lines(kAllLines);
}

void Block::deliver(Signal signal) {
  const bool level = crossbar_.input(signal, pads_.inputs());
  if (is_encoder_input(signal)) {
    encoder_.input(now_, signal, level, *this);
  } else if (within(signal, Signal::gpi0, Signal::gpi15)) {
    gpio_.input(index_from(signal, Signal::gpi0), level);
  } else if (signal == Signal::sdi) {
    touch(spi_unit);
    spi_.advance(now_, *this);
    spi_.input(level);
  } else if (is_open_drain(signal)) {
    bool released = true;
    for_each_line(crossbar_.lines(signal),
                  [&](std::size_t line) { released = released && !held_low(pads_, line); });
    touch(i2c_unit);
    i2c_.advance(now_, *this);
    i2c_.input(signal, released);
  }
}

bool Block::deliver_inputs() {
  const LineSet levels = pads_.inputs();
  const LineSet changed = levels ^ seen_;
  if (changed == 0) {
    return false;
  }
  seen_ = levels;
  for_each_line(changed & crossbar_.input_lines(),
                [this](std::size_t line) { deliver(crossbar_.signal(line)); });
  if ((watchdog_.inputs() >> 32 & changed) != 0) {
    touch(watchdog_unit);
    watchdog_.advance(now_, *this);
    watchdog_.set_lines(levels);
  }
  return true;
}

void Block::tell_listener() {
  for_each_line(std::exchange(untold_, 0) & watched_, [this](std::size_t line) {
    const PinState state = pads_.state(line);
    if (state != shown_[line]) {
      shown_[line] = state;
      if (listener_ != nullptr) {
        listener_->pin_changed(now_, line, state);
      }
    }
  });
}

void Block::apply_crossbar() {
  encoder_.set_mapped(crossbar_.mapped());
  bring_pins_up_to_date();
  update_watching();
  seen_ = pads_.inputs();
  for (std::size_t code = 0; code < kSignals; ++code) {
    const auto signal = static_cast<Signal>(code);
    if (is_encoder_input(signal)) {
      encoder_.find(signal, crossbar_.input(signal, seen_));
    } else if (is_input(signal)) {
      deliver(signal);
    }
  }
  watchdog_.set_lines(seen_);
}

void Block::update_watching() {
  LineSet lines = watched_ | (static_cast<LineSet>(watchdog_.inputs() >> 32) & kAllLines);
  for (std::size_t line = kFirstHighVoltage; line < kLines; ++line) {
    if (pads_.short_at(line) != Short::none) {
      lines |= line_bit(line);  // its driver's protection depends on every edge
    }
  }
  const SignalSet signals = crossbar_.outputs_at(lines);
  if (signals == watched_signals_) {
    return;
  }
  bring_pins_up_to_date();
  watched_signals_ = signals;
  spi_.watch(signals);
  i2c_.watch(signals);
  steps_.watch(signals);
  pwm_.watch(signals);
  dac_.watch(signals);
}

void Block::watch(LineSet lines) {
  advance_units();
  settle();
  watched_ = lines & kAllLines;
  update_watching();
  bring_pins_up_to_date();
  for_each_line(watched_, [this](std::size_t line) { shown_[line] = pads_.state(line); });
  settle();
}

void Block::drive(std::size_t line, OutsideDrive outside, base::SimTime time) {
  advance(time);
  pads_.drive(line, outside);
  untold_ |= line_bit(line);
  if (is_open_drain(crossbar_.signal(line))) {
    deliver(crossbar_.signal(line));
  }
  settle();
}

void Block::set_short(std::size_t line, Short fault) {
  bring_pins_up_to_date();
  pads_.set_short(line, fault);
  ++output_changes_;
  untold_ |= line_bit(line);
  update_watching();
  if (is_open_drain(crossbar_.signal(line))) {
    deliver(crossbar_.signal(line));
  }
  settle();
}

void Block::set_supply(std::size_t supply, std::int32_t millivolts) {
  bring_pins_up_to_date();
  pads_.set_supply(supply, millivolts);
  untold_ = kAllLines;
  settle();
}

PinState Block::pin(std::size_t line) {
  bring_pins_up_to_date();
  return pads_.state(line);
}

std::int32_t Block::voltage(std::size_t line) {
  bring_pins_up_to_date();
  return pads_.voltage(line);
}

}  // namespace stator::mfc
