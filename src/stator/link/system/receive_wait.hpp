#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

/// How a receiving thread waits for the next frame. A sleeping one may notice the end of its
/// timeout one tick of the system's scheduler late (1 to 10 ms), a frame at once.
enum class WaitMode : std::uint8_t {
  block,     ///< sleeps: no load when idle; best when it shares the processor with the master
  spin,      ///< looks again and again: shortest answer from another processor, takes all of it
  adaptive,  ///< spins for `spin_time` after the last frame, then sleeps
};

/// Nanoseconds of the machine's monotonic clock.
[[nodiscard]] std::int64_t monotonic_now();

/// Sleeps at most `time` until `descriptor` can be read. False: a signal ended the sleep.
[[nodiscard]] bool sleep_until_readable(int descriptor, base::SimDuration time);

/// The waiting that all links on file descriptors share: three modes, ended by a frame, by the
/// timeout, by a signal or by wake().
class ReceiveWait {
 public:
  /// Longest sleep without a look at wake().
  static constexpr base::SimDuration kWakeInterval{20'000'000};

  /// What one look or one sleep of a source brought.
  struct Taken {
    std::size_t length = 0;    ///< of the frame, 0 = none
    bool interrupted = false;  ///< a signal ended the sleep
  };

  ReceiveWait(WaitMode mode, base::SimDuration spin_time) : mode_(mode), spin_time_(spin_time) {}

  /// EthernetLink::receive() on `source`, which has a function `Expected<Taken, LinkError>
  /// take(buffer, wait)` that sleeps at most `wait` for a frame, or not at all if that is 0.
  template <typename Source>
  [[nodiscard]] base::Expected<std::size_t, LinkError> receive(Source& source,
                                                               std::span<std::byte> buffer,
                                                               base::SimDuration timeout) {
    constexpr base::SimDuration kNothing;
    if (take_wake()) {
      return std::size_t{0};
    }
    if (timeout <= kNothing) {
      return look(source, buffer);
    }
    if (mode_ == WaitMode::block) {
      return sleep(source, buffer, timeout);
    }
    const std::int64_t now = monotonic_now();
    const std::int64_t end = (base::SimDuration(now) + timeout).nanoseconds();
    const std::int64_t spin_end =
        mode_ == WaitMode::spin ? end
                                : std::clamp(last_frame_ + spin_time_.nanoseconds(), now, end);
    auto received = spin(source, buffer, spin_end);
    if (!received || *received != 0 || take_wake() || spin_end == end) {
      return received;
    }
    return sleep(source, buffer, base::SimDuration(end - spin_end));
  }

  /// Ends the present receive() or the next one. From any thread and from a signal handler.
  void wake() noexcept { wake_requested_.store(true, std::memory_order_relaxed); }

 private:
  template <typename Source>
  base::Expected<std::size_t, LinkError> look(Source& source, std::span<std::byte> buffer) {
    const auto taken = source.take(buffer, base::SimDuration());
    if (!taken) {
      return base::Unexpected{taken.error()};
    }
    return note(taken->length);
  }

  template <typename Source>
  base::Expected<std::size_t, LinkError> spin(Source& source, std::span<std::byte> buffer,
                                              std::int64_t until) {
    do {
      auto received = look(source, buffer);
      if (!received || *received != 0) {
        return received;
      }
    } while (!wake_requested_.load(std::memory_order_relaxed) && monotonic_now() < until);
    return std::size_t{0};
  }

  /// Sleeps in slices, between which wake() is noticed.
  template <typename Source>
  base::Expected<std::size_t, LinkError> sleep(Source& source, std::span<std::byte> buffer,
                                               base::SimDuration timeout) {
    while (timeout > base::SimDuration()) {
      const base::SimDuration slice = std::min(timeout, kWakeInterval);
      const auto taken = source.take(buffer, slice);
      if (!taken) {
        return base::Unexpected{taken.error()};
      }
      if (taken->length != 0 || taken->interrupted || take_wake()) {
        return note(taken->length);
      }
      timeout -= slice;
    }
    return std::size_t{0};
  }

  std::size_t note(std::size_t length) {
    if (length != 0 && mode_ == WaitMode::adaptive) {
      last_frame_ = monotonic_now();
    }
    return length;
  }

  bool take_wake() {
    // The plain look first: an exchange for every frame would lock the bus.
    return wake_requested_.load(std::memory_order_relaxed) &&
           wake_requested_.exchange(false, std::memory_order_relaxed);
  }

  WaitMode mode_;
  base::SimDuration spin_time_;
  std::atomic<bool> wake_requested_ = false;
  std::int64_t last_frame_ = 0;  ///< ns of the monotonic clock, for WaitMode::adaptive
};

}  // namespace stator::link
