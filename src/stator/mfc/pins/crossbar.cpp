#include "stator/mfc/pins/crossbar.hpp"

namespace stator::mfc {

bool is_output(Signal signal) {
  const SignalDirection direction = describe(signal).direction;
  return direction == SignalDirection::output || direction == SignalDirection::in_out;
}

bool is_input(Signal signal) {
  const SignalDirection direction = describe(signal).direction;
  return direction == SignalDirection::input || direction == SignalDirection::in_out;
}

void Crossbar::configure(const Configuration& configuration, std::uint32_t high_voltage) {
  lines_.fill(0);
  input_lines_ = 0;
  mapped_ = SignalSet();
  for (std::size_t line = 0; line < kLines; ++line) {
    const std::uint8_t code = configuration.signal(line);
    signals_[line] = code < kSignals ? static_cast<Signal>(code) : Signal::zero;
  }
  for (std::size_t pair = 0; pair < kDifferentialPairs.size(); ++pair) {
    if ((high_voltage >> (24 + pair) & 1U) != 0) {
      signals_[kDifferentialPairs[pair].positive] = Signal::zero;
    }
  }
  for (std::size_t line = 0; line < kLines; ++line) {
    lines_[static_cast<std::size_t>(signals_[line])] |= line_bit(line);
    input_lines_ |= is_input(signals_[line]) ? line_bit(line) : 0;
    mapped_.insert(signals_[line]);
  }
}

SignalSet Crossbar::outputs_at(LineSet lines) const {
  SignalSet signals;
  for (std::size_t line = 0; line < kLines; ++line) {
    if ((lines & line_bit(line)) != 0 && is_output(signals_[line])) {
      signals.insert(signals_[line]);
    }
  }
  return signals;
}

}  // namespace stator::mfc
