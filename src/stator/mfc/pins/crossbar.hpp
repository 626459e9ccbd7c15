#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/mfc/pins/configuration.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// A set of MFC IO lines: bit i is line i, 0..15 MFCIO00..15, 16..23 MFC_HV0..7.
using LineSet = std::uint32_t;
inline constexpr LineSet kAllLines = 0x00FF'FFFF;
[[nodiscard]] constexpr LineSet line_bit(std::size_t line) {
  return LineSet{1} << line;
}

/// Two high-voltage lines that are compared (TMC8461 datasheet L8667-L8686, L10349-L10375).
struct DifferentialPair {
  std::size_t positive;  ///< line; its crossbar setting is ignored
  std::size_t negative;  ///< line at which the result is read
};
/// By their bits in HVIO_CFG 27:24.
inline constexpr std::array<DifferentialPair, 4> kDifferentialPairs{{
    {kFirstHighVoltage + 3, kFirstHighVoltage + 0},
    {kFirstHighVoltage + 4, kFirstHighVoltage + 1},
    {kFirstHighVoltage + 5, kFirstHighVoltage + 2},
    {kFirstHighVoltage + 7, kFirstHighVoltage + 6},
}};

/// Which signal each line carries (TMC8461 datasheet section 7.5, L8415-L8624). Any signal can be
/// on any line, and on several. Codes without a signal count as 0 (T61-XBAR-003).
class Crossbar {
 public:
  /// Nothing connected.
  Crossbar() { configure(Configuration{}, 0); }

  /// Takes over the lines' bytes. `high_voltage` is HVIO_CFG: the positive line of a differential
  /// pair carries no signal.
  void configure(const Configuration& configuration, std::uint32_t high_voltage);

  [[nodiscard]] Signal signal(std::size_t line) const { return signals_[line]; }
  /// The lines that carry `signal`.
  [[nodiscard]] LineSet lines(Signal signal) const {
    return lines_[static_cast<std::size_t>(signal)];
  }
  /// The lines to which a unit listens.
  [[nodiscard]] LineSet input_lines() const { return input_lines_; }
  /// Signals that have a line.
  [[nodiscard]] const SignalSet& mapped() const { return mapped_; }
  /// The level of an input signal: lines that carry it are combined by OR (L8437-L8445).
  [[nodiscard]] bool input(Signal signal, LineSet levels) const {
    return (lines(signal) & levels) != 0;
  }
  /// The output signals of `lines`.
  [[nodiscard]] SignalSet outputs_at(LineSet lines) const;

 private:
  std::array<Signal, kLines> signals_{};
  std::array<LineSet, kSignals> lines_{};
  LineSet input_lines_ = 0;
  SignalSet mapped_;
};

/// A unit can drive a line that carries `signal`.
[[nodiscard]] bool is_output(Signal signal);
/// A unit listens to a line that carries `signal`.
[[nodiscard]] bool is_input(Signal signal);

}  // namespace stator::mfc
