#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "stator/rack/run/task_queue.hpp"
#include "stator/web/job.hpp"
#include "stator/web/state.hpp"
#include "stator/web/stream/signal_stream.hpp"

namespace stator::web {

/// Gets the answer of a job.
class Waiter {
 public:
  Waiter() = default;
  Waiter(const Waiter&) = delete;
  Waiter& operator=(const Waiter&) = delete;
  virtual ~Waiter() = default;

  virtual void answer(Response response) = 0;
};

/// A client for whom the rack samples signals and fetches events.
class TapOwner {
 public:
  TapOwner() = default;
  TapOwner(const TapOwner&) = delete;
  TapOwner& operator=(const TapOwner&) = delete;
  virtual ~TapOwner() = default;

  /// The rack samples from now on.
  virtual void tapped() = 0;
  /// Time to take the rows that wait.
  virtual void collect(rack::SignalTap& tap) = 0;
  /// Time to look for events, if they are watched.
  virtual void collect_events() = 0;
};

/// The way of the server's thread into the rack, which is its task queue: jobs under way, and taps
/// inside the rack. Owns them until the rack has done with them, whatever becomes of who wanted
/// them.
class RackAccess {
 public:
  using Clock = std::chrono::steady_clock;

  /// `rack_time`: for the rack to do a job; `wake` has tick() called soon.
  RackAccess(State& state, rack::TaskQueue& tasks, std::chrono::milliseconds rack_time,
             std::function<void()> wake);

  /// False: too many are under way. `waiter` may be null.
  [[nodiscard]] bool post(std::unique_ptr<Job> job, std::shared_ptr<Waiter> waiter);

  /// Samples for `owner`, in addition to what it has.
  void tap(std::shared_ptr<TapOwner> owner, const Subscription& subscription);
  /// Ends all its taps.
  void untap(const TapOwner& owner);
  /// Has events fetched often, until `owner` no longer wants them.
  void watch_events(std::weak_ptr<TapOwner> owner);
  void unwatch_events(const TapOwner& owner);
  /// Values per second that others than `asking` leave of kMostValuesPerSecond.
  [[nodiscard]] std::int64_t values_left(const TapOwner& asking) const;

  /// Goes on with everything; to be called periodically.
  void tick(Clock::time_point now);
  /// Something is under way: tick() should be called more often.
  [[nodiscard]] bool busy() const;
  /// A client waits for an answer.
  [[nodiscard]] bool anybody_waits() const;
  /// Drops all that wait for answers and samples; the rack may still have the tasks.
  void forget_all();

 private:
  struct Waiting {
    std::unique_ptr<Job> job;
    std::shared_ptr<Waiter> waiter;  ///< null: nobody waits any more
    Clock::time_point deadline;
    bool resting = false;    ///< it is to look again at the next tick
    bool under_way = false;  ///< it has rested: what it ordered has begun
  };

  struct Tap {
    std::unique_ptr<TapTask> task;
    std::shared_ptr<TapOwner> owner;  ///< null: it is on its way out
    std::int64_t values_per_second = 0;
    bool under_way = false;  ///< the rack has the task
    bool inside = false;     ///< the rack samples
  };

  void finish_job(const rack::QueuedTask& task);
  void finish_tap(const rack::QueuedTask& task);
  void drop_late(Clock::time_point now);
  void look_again();
  void serve_taps();
  void collect();

  State& state_;
  rack::TaskQueue& tasks_;
  std::chrono::milliseconds rack_time_;
  std::function<void()> wake_;
  std::deque<Waiting> waiting_;
  std::deque<Tap> taps_;
  bool posted_before_tick_ = false;  ///< what waits in the task queue has been there for a tick
  std::vector<std::weak_ptr<TapOwner>> event_watchers_;
  Clock::time_point next_collect_;
  Clock::time_point next_fetch_;
};

}  // namespace stator::web
