#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include "base/sim_time.hpp"
#include "rack/clock.hpp"
#include "rack/desk.hpp"
#include "rack/inheriting_mutex.hpp"
#include "rack/rack.hpp"

namespace spdlog {
class logger;
}

namespace stator::rack {

/// What the threads of a runner share: one of them at a time touches the rack.
struct RunningRack {
  /// Lag behind the machine's clock from which on an overrun is counted.
  static constexpr base::SimDuration kOverrun{20'000'000};

  /// `start`: where the rack stands in simulated time; `priority_of_threads`: see priority.
  RunningRack(Rack& shared, const RackConfiguration& configuration,
              std::shared_ptr<spdlog::logger> told, base::SimTime start,
              std::optional<int> priority_of_threads = std::nullopt)
      : rack(shared),
        clock_kind(configuration.clock),
        real_clock(start),
        lockstep_clock(configuration.cycle, configuration.step),
        logger(std::move(told)),
        priority(priority_of_threads),
        next_keeping(start) {
    lockstep_clock.advance_to(start);
  }

  /// Simulated time; the mutex must be held.
  [[nodiscard]] base::SimTime now() const {
    return clock_kind == ClockKind::real ? real_clock.now() : lockstep_clock.now();
  }
  /// What time stamps that programs see add to simulated time: nothing in lockstep, where it is the
  /// master's.
  [[nodiscard]] base::SimDuration epoch() const {
    return clock_kind == ClockKind::real ? real_clock.epoch() : base::SimDuration();
  }
  /// Brings the rack to the machine's present and returns by how much it lagged; the mutex must be
  /// held.
  base::SimDuration catch_up() {
    const base::SimTime present = real_clock.now();
    rack.advance(present);
    return real_clock.now() - present;
  }
  /// To be called first by a thread that answers what comes: gives it its processor, if it has one,
  /// and its priority. What is not granted is logged.
  void enter_thread(std::optional<unsigned> cpu) const;
  /// Lets devices hear what has become of what they ordered to be kept, for which it takes the
  /// mutex, and looks now and then for files that could not be written and for what the log has
  /// counted.
  void keep_files();
  /// Does a few of the tasks that wait at the desk, if there are any; takes the mutex. For a thread
  /// that has answered what came.
  void serve_desk();
  /// Tells of the `count`th overrun, with the lag that was seen.
  void log_overrun(std::uint64_t count, base::SimDuration lag) const;

  Rack& rack;
  ClockKind clock_kind;
  RealClock real_clock;
  LockstepClock lockstep_clock;
  std::shared_ptr<spdlog::logger> logger;
  std::optional<int> priority;  ///< real-time priority of the threads that answer what comes
  InheritingMutex mutex;        ///< guards rack, lockstep_clock, next_keeping and all statistics
  base::SimTime next_keeping;
  std::atomic<bool> stopping{false};
  Desk desk;
};

}  // namespace stator::rack
