#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "stator/base/sim_time.hpp"

namespace stator::mfc {

/// Signals that the crossbar connects with the MFC IO pins, by their codes in the crossbar
/// registers (TMC8461 datasheet L8461-L8613).
enum class Signal : std::uint8_t {
  zero = 0,
  low,
  high,
  tri,
  a,
  an,
  b,
  bn,
  n,
  nn,
  sck,
  sdi,
  sdo,
  cs0,
  cs1,
  cs2,
  cs3,
  scl,
  sda,
  s0,
  d0,
  s1,
  d1,
  s2,
  d2,
  s0n,
  d0n,
  s1n,
  d1n,
  s2n,
  d2n,
  hs0,
  ls0,
  hs1,
  ls1,
  hs2,
  ls2,
  hs3,
  ls3,
  gpi0,
  gpi1,
  gpi2,
  gpi3,
  gpi4,
  gpi5,
  gpi6,
  gpi7,
  gpi8,
  gpi9,
  gpi10,
  gpi11,
  gpi12,
  gpi13,
  gpi14,
  gpi15,
  gpo0,
  gpo1,
  gpo2,
  gpo3,
  gpo4,
  gpo5,
  gpo6,
  gpo7,
  gpo8,
  gpo9,
  gpo10,
  gpo11,
  gpo12,
  gpo13,
  gpo14,
  gpo15,
  dac0,
  pulse_a,
  pulse_c,
  pulse_b,
  pulse_ab,
  pulse_z,
};
inline constexpr std::size_t kSignals = 77;

/// Seen from the unit inside the chip.
enum class SignalDirection : std::uint8_t { none, input, output, in_out };

/// A row of the crossbar's table.
struct SignalDescription {
  Signal signal;
  std::string_view name;   ///< as the document spells it
  std::string_view block;  ///< the unit it belongs to; "none" for static levels
  SignalDirection direction;
};

/// All signals in the order of their codes.
[[nodiscard]] const std::array<SignalDescription, kSignals>& signal_table();
[[nodiscard]] inline const SignalDescription& describe(Signal signal) {
  return signal_table()[static_cast<std::size_t>(signal)];
}

/// The signal `index` codes behind `first`, e.g. GPO5 as offset(Signal::gpo0, 5).
[[nodiscard]] constexpr Signal offset(Signal first, std::size_t index) {
  return static_cast<Signal>(static_cast<std::size_t>(first) + index);
}

/// A set of signals: which ones somebody watches, which ones are mapped.
class SignalSet {
 public:
  constexpr SignalSet() = default;
  constexpr SignalSet(std::initializer_list<Signal> signals) {
    for (const Signal signal : signals) {
      insert(signal);
    }
  }
  constexpr void insert(Signal signal) { words_[word(signal)] |= bit(signal); }
  constexpr void erase(Signal signal) { words_[word(signal)] &= ~bit(signal); }
  [[nodiscard]] constexpr bool contains(Signal signal) const {
    return (words_[word(signal)] & bit(signal)) != 0;
  }
  [[nodiscard]] constexpr bool contains_any(const SignalSet& other) const {
    return (words_[0] & other.words_[0]) != 0 || (words_[1] & other.words_[1]) != 0;
  }
  [[nodiscard]] constexpr bool empty() const { return words_[0] == 0 && words_[1] == 0; }
  friend constexpr bool operator==(const SignalSet&, const SignalSet&) = default;

 private:
  static constexpr std::size_t word(Signal signal) { return static_cast<std::size_t>(signal) / 64; }
  static constexpr std::uint64_t bit(Signal signal) {
    return std::uint64_t{1} << (static_cast<unsigned>(signal) % 64);
  }
  std::array<std::uint64_t, 2> words_{};
};

/// Interrupt sources by their bits in MFCIO_IRQ_CFG and MFCIO_IRQ_FLAGS (L7541-L7587).
enum class IrqSource : std::uint8_t {
  enc_n_event = 0,
  sd0_target_reached,
  sd1_target_reached,
  sd2_target_reached,
  sd0_compare,
  sd1_compare,
  sd2_compare,
  spi_new_data,
  i2c_new_data,
  i2c_tx_complete,
  i2c_new_data_or_tx_complete,
  mfc_watchdog_timeout,
  pwm_zero_pulse,
  pwm_center_pulse,
  pwm_a_pulse,
  pwm_b_pulse,
  hv_ot_flag,
  bvout_ot_flag,
  bvout_sc_flag,
  b3v3_sc_flag,
  mfc_nes_emergency = 23,
};

/// A set of interrupt sources in the layout of MFCIO_IRQ_CFG.
using IrqSet = std::uint32_t;
[[nodiscard]] constexpr IrqSet irq_bit(IrqSource source) {
  return IrqSet{1} << static_cast<unsigned>(source);
}
[[nodiscard]] constexpr IrqSource offset(IrqSource first, std::size_t index) {
  return static_cast<IrqSource>(static_cast<std::size_t>(first) + index);
}

/// What units tell of what they do, in order of time within one unit. The sink may act on other
/// units; it does not call the unit that is telling.
class SignalSink {
 public:
  SignalSink() = default;
  SignalSink(const SignalSink&) = default;
  SignalSink& operator=(const SignalSink&) = default;
  SignalSink(SignalSink&&) = default;
  SignalSink& operator=(SignalSink&&) = default;
  virtual ~SignalSink() = default;

  /// A watched output has changed. Of open-drain signals (SCL, SDA) high means released.
  virtual void change(base::SimTime time, Signal signal, bool level) = 0;
  /// A watched output is driven (true) or high-impedance from now on: general purpose outputs.
  virtual void enable(base::SimTime time, Signal signal, bool driven) = 0;
  /// The event behind an interrupt source, whether or not its interrupt is masked.
  virtual void interrupt(base::SimTime time, IrqSource source) = 0;
};

// The rules of all units of this room:
//
// - Units are values: a copy is a snapshot. They allocate nothing and throw nothing.
// - advance(to, sink) makes everything that happens up to and at `to`. Before anything is written,
//   read or put into a unit at some time, it is advanced to that time. What a write or an input
//   changes at once goes to the sink with that time.
// - A write counts from the last edge of the unit's clock; to be exact to the clock, it has to be
//   at Clock25MHz::next_edge().
// - watch(signals) says which outputs are watched, listen(sources) whose events are needed in time.
//   next_event() is the next moment at which one of these happens, or at which the unit must act on
//   the outside; it is not later than that, and never() if nothing will happen by itself. Changes
//   of other outputs are neither computed nor passed on. Events of other sources go to the sink
//   when the unit is advanced past them; those of PWM marks once per call of advance().

}  // namespace stator::mfc
