#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::mfc {

/// A clock of the chip: edges every `nanoseconds`, the first at power-on (SimTime 0). Ticks count
/// its edges; nothing ticks in the simulation.
template <std::int64_t nanoseconds>
struct Clock {
  static constexpr std::int64_t kPeriod = nanoseconds;
  /// The tick of something that never happens.
  static constexpr std::int64_t kNever = base::SimTime::never().nanoseconds() / nanoseconds;

  /// The last edge at or before `time`, which is not before power-on.
  static constexpr std::int64_t last_tick(base::SimTime time) {
    return time.nanoseconds() / nanoseconds;
  }
  /// When edge `tick` comes; never() for kNever and later.
  static constexpr base::SimTime time_of(std::int64_t tick) {
    return tick >= kNever ? base::SimTime::never()
                          : base::SimTime(base::SimDuration(tick * nanoseconds));
  }
  /// The first edge at or after `time`: when the clocked logic takes notice of it.
  static constexpr base::SimTime next_edge(base::SimTime time) {
    return time == base::SimTime::never()
               ? time
               : time_of((time.nanoseconds() + nanoseconds - 1) / nanoseconds);
  }
};

using Clock25MHz = Clock<40>;   ///< SPI master, step and direction, watchdog
using Clock100MHz = Clock<10>;  ///< PWM, DAC, I2C master

}  // namespace stator::mfc
