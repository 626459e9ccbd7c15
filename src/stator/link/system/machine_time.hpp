#pragma once

#include <chrono>
#include <ctime>

namespace stator::link {

/// The machine's time, for what a protocol does on the clock alone.
using MachineTime = std::chrono::steady_clock::time_point;

/// As timerfd_settime() takes it with CLOCK_MONOTONIC.
[[nodiscard]] inline timespec to_timespec(MachineTime time) {
  const auto since = time.time_since_epoch();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(since);
  const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(since - seconds);
  return {.tv_sec = static_cast<time_t>(seconds.count()),
          .tv_nsec = static_cast<long>(rest.count())};
}

}  // namespace stator::link
