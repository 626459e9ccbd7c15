#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/observe/inheriting_mutex.hpp"
#include "stator/rack/observe/log.hpp"
#include "stator/rack/run/task_queue.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::rack {

/// What the threads of a runner share: one of them at a time touches the rack.
///
/// On the machine's clock the devices are brought to the present in slices, so that no thread holds
/// the rack for long, what comes is answered in between and a request to stop is seen. A rack that
/// keeps up needs one slice each time. One that does not lags: what comes then meets the devices
/// where they are, and lag beyond kWorstLag is given up by setting the clock back, for all devices
/// alike.
struct RunningRack {
  /// Lag behind the machine's clock from which on an overrun is counted.
  static constexpr base::SimDuration kOverrun{20'000'000};
  /// Lag that is never caught up.
  static constexpr base::SimDuration kWorstLag{500'000'000};
  /// What a slice is to take of the machine's time.
  static constexpr base::SimDuration kSliceTime{3'000'000};
  /// Simulated time in a slice.
  static constexpr base::SimDuration kShortestSlice{50'000};
  static constexpr base::SimDuration kLongestSlice = kOverrun;

  /// `start`: where the rack stands in simulated time; `priority_of_threads`: see priority.
  RunningRack(Rack& shared, const RackConfiguration& configuration, std::shared_ptr<Log> log,
              base::SimTime start, std::optional<int> priority_of_threads = std::nullopt)
      : rack(shared),
        clock_kind(configuration.clock),
        real_clock(start),
        lockstep_clock(configuration.cycle, configuration.step),
        logger(std::move(log)),
        priority(priority_of_threads),
        reached(start),
        handed_out(start),
        next_keeping(start) {
    lockstep_clock.advance_to(start);
  }

  /// Simulated time; the mutex must be held. Never earlier than before, and never further ahead of
  /// the devices than the next slice takes them if they lag.
  [[nodiscard]] base::SimTime now() {
    return clock_kind == ClockKind::real ? present() : lockstep_clock.now();
  }
  /// The machine's present in simulated time. From any thread; a thread without the mutex may read
  /// a later time than it reads afterwards, when the clock is set back.
  [[nodiscard]] base::SimTime machine_now() const {
    return real_clock.now() - base::SimDuration(set_back_ns.load(std::memory_order_relaxed));
  }
  /// The machine's present is earlier by `time` from now on. The epoch stays.
  void set_back(base::SimDuration time) {
    set_back_ns.fetch_add(time.nanoseconds(), std::memory_order_relaxed);
  }
  /// What time stamps that programs see add to simulated time: nothing in lockstep, where it is the
  /// master's.
  [[nodiscard]] base::SimDuration epoch() const {
    return clock_kind == ClockKind::real ? real_clock.epoch() : base::SimDuration();
  }
  /// To be called when the threads start: what passed since construction is not for the devices to
  /// catch up.
  void begin();
  /// Brings the rack a slice further, or to the machine's present if that is nearer; the mutex must
  /// be held. `statistics` are those of the thread: the first that sees an overrun counts it.
  template <typename Statistics>
  void catch_up(Statistics& statistics) {
    const Lag lag = advance_slice();
    statistics.worst_lag_ns = std::max(statistics.worst_lag_ns, lag.duration.nanoseconds());
    if (lag.is_new) {
      log_overrun(++statistics.overruns, lag.duration);
    }
  }
  /// The same for a thread that counts nothing.
  void catch_up() { advance_slice(); }
  /// The rack has not come to the machine's present: another slice is due at once. From any thread.
  [[nodiscard]] bool lags() const { return lagging.load(std::memory_order_relaxed); }
  /// To be called first by a thread that answers what comes: gives it its processor, if it has one,
  /// and its priority. What is not granted is logged.
  void enter_thread(std::optional<unsigned> cpu) const;
  /// Lets devices hear what has become of what they ordered to be kept, for which it takes the
  /// mutex, and looks now and then for files that could not be written and for what the log has
  /// counted.
  void keep_files();
  /// Does a few of the tasks that wait in the task queue, if there are any; takes the mutex. For a
  /// thread that has answered what came.
  void serve_tasks();
  /// Tells of the `count`th overrun, with the lag that was seen.
  void log_overrun(std::uint64_t count, base::SimDuration lag) const;

  Rack& rack;
  ClockKind clock_kind;
  RealClock real_clock;
  LockstepClock lockstep_clock;
  std::shared_ptr<Log> logger;
  std::optional<int> priority;  ///< real-time priority of the threads that answer what comes
  InheritingMutex mutex;        ///< guards rack, lockstep_clock, all times below and all statistics
  base::SimTime reached;        ///< where the last slice brought the devices
  base::SimTime handed_out;     ///< the latest moment at which something came
  base::SimDuration slice = kLongestSlice;
  base::SimDuration lost;  ///< time given up
  bool overrunning = false;
  std::atomic<std::int64_t> set_back_ns{0};
  std::atomic<bool> lagging{false};
  base::SimTime next_keeping;
  std::atomic<bool> stopping{false};
  TaskQueue tasks;

 private:
  struct Lag {
    base::SimDuration duration;
    bool is_new = false;  ///< an overrun begins
  };
  [[nodiscard]] base::SimTime present();
  Lag advance_slice();
  void adapt_slice(base::SimDuration simulated, base::SimDuration took);
  void give_up(base::SimDuration time);
};

}  // namespace stator::rack
