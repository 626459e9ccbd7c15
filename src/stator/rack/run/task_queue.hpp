#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>

#include "stator/base/sim_time.hpp"
#include "stator/rack/run/hand_over_queue.hpp"

namespace stator::rack {

class Rack;
class View;

/// Something that somebody outside wants to have done with a running rack: a Look or an Act.
/// Belongs to the thread that posted it until it is posted and after it is done.
///
/// It is done in a thread of the rack's networks that holds the rack, which has been brought to
/// `now`. That takes some microseconds at most and must not throw; a long task does a part in each
/// call and returns false until it is done.
class QueuedTask {
 public:
  QueuedTask() = default;
  QueuedTask(const QueuedTask&) = delete;
  QueuedTask& operator=(const QueuedTask&) = delete;
  virtual ~QueuedTask() = default;

 private:
  friend class TaskQueue;
  friend class Look;
  friend class Act;
  virtual bool run(Rack& rack, base::SimTime now) = 0;
  /// Others may have to act sooner because of it.
  [[nodiscard]] virtual bool changes() const = 0;
};

/// A task that only looks: a value read, a state listed.
class Look : public QueuedTask {
 public:
  virtual bool look(const View& rack, base::SimTime now) = 0;

 private:
  bool run(Rack& rack, base::SimTime now) final;
  [[nodiscard]] bool changes() const final { return false; }
};

/// A task that does something to the rack: an input set, an object written.
class Act : public QueuedTask {
 public:
  virtual bool act(Rack& rack, base::SimTime now) = 0;

 private:
  bool run(Rack& rack, base::SimTime now) final { return act(rack, now); }
  [[nodiscard]] bool changes() const override { return true; }
};

/// Where tasks for a running rack are handed in and fetched again. Nobody waits here: the threads
/// of the networks look for tasks when they have answered what came, and do a few at a time; who
/// posts a task looks for its end later. One thread posts and fetches.
class TaskQueue {
 public:
  /// Tasks under way at most, a power of two.
  static constexpr std::size_t kCapacity = 64;
  /// Calls of Look::look() and Act::act() in one look: what a network's thread spends here at most.
  static constexpr int kCallsPerLook = 4;

  /// False: so many tasks are under way that the rack takes no more.
  bool post(QueuedTask& task);
  /// A task that is done; null: none.
  [[nodiscard]] QueuedTask* take_done();

  /// Wakes threads that sleep, so that one of them does what waits.
  void wake_rack() const {
    if (waker_) {
      waker_();
    }
  }
  /// Somebody is there who may post at any moment: threads that cannot be woken sleep shorter.
  void attend(bool attended) { attended_.store(attended, std::memory_order_relaxed); }

  // For the threads of the rack.

  [[nodiscard]] bool attended() const { return attended_.load(std::memory_order_relaxed); }
  /// `waker` is called by wake_rack(), in whatever thread that is.
  void set_waker(std::function<void()> waker) { waker_ = std::move(waker); }
  /// There is something to do; costs next to nothing.
  [[nodiscard]] bool waiting() const { return !posted_.empty(); }
  /// For the thread that holds the rack. True: something has changed because of which other threads
  /// may have to act sooner.
  bool serve(Rack& rack, base::SimTime now);

 private:
  HandOverQueue<QueuedTask*, kCapacity> posted_;
  HandOverQueue<QueuedTask*, kCapacity> done_;
  std::function<void()> waker_;
  std::atomic<bool> attended_{false};
  std::size_t under_way_ = 0;  ///< of the posting thread; bounds both queues
};

}  // namespace stator::rack
