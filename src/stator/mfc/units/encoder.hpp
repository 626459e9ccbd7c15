#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// The incremental encoder unit (registers 0 to 5; TMC8461 datasheet L8953-L9028, L6443-L6618):
/// counts every change of A and B by a signed factor, and latches or clears the position at N
/// events. It acts on edges as they come; by itself it does nothing, so it has no next_event().
class Encoder {
 public:
  /// Tells which of the signals A, An, B, Bn, N, Nn have a pin. A signal without its negative uses
  /// its own level; with it, the pair decides: equal levels keep the previous value. Where
  /// neither N nor Nn has a pin there are no N events (G-07). Initially all but the negatives have.
  void set_mapped(const SignalSet& mapped);
  /// The pin of `signal` (one of A to Nn) has `level` from `time` on. Times do not decrease.
  void input(base::SimTime time, Signal signal, bool level, SignalSink& sink);
  /// A new connection finds `signal` at `level`: no edge, so nothing is counted and no N event
  /// comes of it (G-34).
  void find(Signal signal, bool level);

  /// ENC_MODE, register 0: bits 0 to 10, others read 0. A write with clr_once arms it again.
  void write_mode(base::SimTime time, std::uint16_t mode, SignalSink& sink);
  [[nodiscard]] std::uint16_t mode() const { return mode_; }
  /// X_ENC, registers 2 and 3: counts, modulo 2^32. Writing it drops the fraction.
  void write_position(std::int32_t position);
  [[nodiscard]] std::int32_t position() const { return position_; }
  /// ENC_CONST, register 4: counts per edge as 16.16, or in decimal mode 16 bits and 0 to 9999.
  void write_constant(std::uint32_t constant) { constant_ = constant; }
  [[nodiscard]] std::uint32_t constant() const { return constant_; }
  /// ENC_LATCH, register 5: X_ENC at the last N event that latched.
  [[nodiscard]] std::int32_t latch() const { return latch_; }

  /// ENC_STATUS, register 1: bit 0 tells of an N event since the last read, or of a level-sensitive
  /// one that is going on, as from power-on where ENC_MODE is 0 and A, B, N are low. This read
  /// clears it, unless the event goes on.
  std::uint8_t read_status();
  /// The same without clearing.
  [[nodiscard]] std::uint8_t status() const { return n_event_ || event_goes_on() ? 1 : 0; }

 private:
  /// Levels of a signal and its negative, and what they mean.
  struct Pair {
    bool positive = false;
    bool negative = false;
    bool differential = false;
    bool level = false;
    /// True if the level has changed.
    bool settle();
  };

  Pair& pair_of(Signal signal);
  /// True if what its pair means has changed.
  bool put(Signal signal, bool level);
  void count(bool upwards);
  template <std::int64_t unit>
  void count_by(bool upwards);
  [[nodiscard]] bool event_condition() const;
  [[nodiscard]] bool event_goes_on() const;
  /// Looks at A, B, N after a change of theirs or of the mode.
  void update_event(base::SimTime time, SignalSink& sink);
  void n_event(base::SimTime time, SignalSink& sink);

  Pair a_, b_, n_;
  bool n_has_pin_ = true;
  std::uint16_t mode_ = 0;
  std::uint32_t constant_ = 0x10000;
  std::int32_t position_ = 0;
  std::uint32_t fraction_ = 0;  ///< in 1/65536 or 1/10000 counts, upwards from position_
  std::int32_t latch_ = 0;
  bool condition_ = true;  ///< A, B, N are as ENC_MODE requires: all low
  bool once_armed_ = false;
  bool n_event_ = false;
};

}  // namespace stator::mfc
