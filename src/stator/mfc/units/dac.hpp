#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// The 1-bit converter (register 50; TMC8461 datasheet L9946-L9974): its output is high while a
/// pseudo-random 16-bit number, new every 10 ns, is below DAC_VAL. In 65536 ticks every number
/// comes once. Edges are computed only while DAC0 is watched. The rules of all units are in
/// signal.hpp.
class Dac {
 public:
  void advance(base::SimTime to, SignalSink& sink);
  [[nodiscard]] base::SimTime next_event() const;
  void watch(const SignalSet& signals);

  /// DAC_VAL.
  void write_value(std::uint16_t value, SignalSink& sink);
  [[nodiscard]] std::uint16_t value() const { return value_; }

  /// Level of DAC0.
  [[nodiscard]] bool level() const;
  /// Share of the time that the output is high, 0 to 65535/65536.
  [[nodiscard]] double mean() const { return static_cast<double>(value_) / 65536.0; }

  /// The pseudo-random number of a tick of 10 ns since power-on.
  [[nodiscard]] static std::uint16_t number(std::int64_t tick);

 private:
  [[nodiscard]] bool level_at(std::int64_t tick) const { return number(tick) < value_; }
  [[nodiscard]] std::int64_t next_change(std::int64_t tick) const;

  std::uint16_t value_ = 0;
  bool watched_ = false;
  base::SimTime now_;
  std::int64_t next_change_ = 0;  ///< tick, if watched
};

}  // namespace stator::mfc
