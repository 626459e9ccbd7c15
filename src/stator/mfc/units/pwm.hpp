#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/units/pwm_geometry.hpp"

namespace stator::mfc {

/// The PWM unit (registers 36 to 46; TMC8461 datasheet L9756-L9935): four half bridges on one
/// 12-bit counter of 100 MHz, and trigger pulses at its positions zero, center, A and B. Edges are
/// computed for watched signals, marks for listened sources; anything else takes no time. The rules
/// of all units are in signal.hpp.
class Pwm {
 public:
  static constexpr std::size_t kChannels = PwmGeometry::kChannels;

  void advance(base::SimTime to, SignalSink& sink);
  [[nodiscard]] base::SimTime next_event() const;
  void watch(const SignalSet& signals);
  void listen(IrqSet sources);

  /// PWM_CFG, 64 bits. In force at once; a counter beyond the new PWM_MAXCNT begins anew at 0.
  void write_configuration(std::uint64_t configuration, SignalSink& sink);
  /// PWM1 to PWM4 (channel 0 to 3): on time in counts; 0 is off, above PWM_MAXCNT always on.
  void write_duty(std::size_t channel, std::uint16_t duty, SignalSink& sink);
  /// PWMx_CNTRSHFT: delay of a channel's edges in counts, modulo the period.
  void write_shift(std::size_t channel, std::uint16_t shift, SignalSink& sink);
  /// PWM_PULSE_B_PULSE_A: position of A in bits 11:0, of B in bits 27:16.
  void write_marks(std::uint32_t marks, SignalSink& sink);
  /// PWM_PULSE_LENGTH in 10 ns; with 0 the pins show no pulses, the marks are there all the same.
  void write_pulse_length(std::uint8_t length, SignalSink& sink);
  /// While active, all gate outputs are off; the counter and the pulses go on.
  void set_emergency(bool active, SignalSink& sink);

  [[nodiscard]] std::uint64_t configuration() const { return geometry_.settings().configuration; }
  [[nodiscard]] std::uint16_t duty(std::size_t channel) const {
    return geometry_.settings().duty[channel];
  }
  [[nodiscard]] std::uint16_t shift(std::size_t channel) const {
    return geometry_.settings().shift[channel];
  }
  [[nodiscard]] std::uint32_t marks() const { return geometry_.settings().marks; }
  [[nodiscard]] std::uint8_t pulse_length() const { return geometry_.settings().pulse_length; }

  /// Level of HS0 to LS3 or of a pulse signal, polarity included.
  [[nodiscard]] bool level(Signal signal) const;
  /// Shares of a period that a channel's switches are on, dead times deducted.
  [[nodiscard]] OnShare on_share(std::size_t channel) const { return geometry_.on_share(channel); }
  /// Period of the counter; 10 ns if it stands (PWM_MAXCNT 0).
  [[nodiscard]] base::SimDuration period() const;
  /// Position of the counter now.
  [[nodiscard]] std::uint16_t counter() const;

 private:
  template <typename Change>
  void reconfigure(SignalSink& sink, Change change);
  void refresh(std::int64_t tick);
  void tell_outputs(base::SimTime time, std::int64_t tick, SignalSink& sink);
  [[nodiscard]] std::int64_t next_tick(std::uint32_t marks) const;
  std::uint32_t make_tick(std::int64_t tick, std::uint32_t marks, SignalSink& sink);

  static constexpr std::size_t kOutputs = PwmGeometry::kOutputs;
  static constexpr std::size_t kMarks = 4;  ///< zero, center, A, B: interrupt sources 12 to 15
  static constexpr std::uint32_t kAllMarks = (1U << kMarks) - 1;
  PwmGeometry geometry_;
  std::uint32_t watched_ = 0;   ///< bit i: output i
  std::uint32_t shown_ = 0;     ///< bit i: level of output i, if watched
  std::uint32_t listened_ = 0;  ///< bit i: mark i
  base::SimTime now_;
  std::array<std::int64_t, kOutputs> next_change_{};  ///< ticks, of watched outputs
  std::array<std::int64_t, kMarks> next_mark_{PwmGeometry::kNever, PwmGeometry::kNever,
                                              PwmGeometry::kNever,
                                              PwmGeometry::kNever};  ///< ticks behind now_
};

}  // namespace stator::mfc
