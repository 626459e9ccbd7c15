// A rack of the package: on a bench, or in real time on links, and who may touch it.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "own_device.hpp"
#include "signal_store.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/bench/bench.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::python {

/// Simulated seconds as a duration. Throws std::runtime_error, with `what`, for those that are
/// negative, not finite or beyond 292 years.
[[nodiscard]] base::SimDuration duration_of(double seconds, const char* what);

/// Somebody with a place in a rack, which has to leave before the rack ends.
class Guest {
 public:
  Guest() = default;
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;
  virtual ~Guest() = default;
  /// Gives the place back. The rack is held.
  virtual void leave() = 0;
};

/// A rack and its simulated time. In lockstep it is a bench, on which time passes with what masters
/// send and wait for, or, while it is paced, with the machine's clock; with links it runs as
/// `stator run` runs it. One thread at a time touches it, without the interpreter's lock.
class Session {
 public:
  struct Options {
    bool links = false;  ///< open the links, ports and lines of the file, in real time
    base::SimDuration limit = base::SimDuration::max();  ///< simulated time, without links
    std::vector<std::string> signals;                    ///< patterns of those that are recorded
    base::SimDuration period{1'000'000};                 ///< between two samples
    std::shared_ptr<DeviceFailure> failure;              ///< of devices in Python; never null
  };

  /// Builds the rack. Throws std::runtime_error for what cannot be built or opened.
  Session(rack::RackConfiguration configuration, const Options& options);
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;
  ~Session();

  /// Calls `work` while this thread holds the rack, and not the interpreter. Throws
  /// std::runtime_error if the rack is closed, and what a device in Python threw. What was sampled
  /// meanwhile is kept.
  template <typename Work>
  auto held(Work&& work) {
    const nanobind::gil_scoped_release released;
    if constexpr (std::is_void_v<decltype(work())>) {
      held_without_interpreter(std::forward<Work>(work));
      failure_->raise();
    } else {
      auto result = held_without_interpreter(std::forward<Work>(work));
      failure_->raise();
      return result;
    }
  }
  /// The same for threads that do not hold the interpreter, and without what devices threw.
  template <typename Work>
  auto held_without_interpreter(Work&& work) {
    const Holding holding(*this);
    return work();
  }

  /// Waits, without the interpreter's lock and without holding the rack, until `reached`, which is
  /// asked while the rack is held, or until `duration` of the machine's time is over. False: it is
  /// over, or the rack is closed.
  bool wait_until(const std::function<bool()>& reached, std::chrono::nanoseconds duration);
  /// Has all who wait ask again.
  void notify() { changed_.notify_all(); }

  /// Lets simulated time pass; with links or while paced it waits for it to pass. Returns early
  /// when a signal such as Ctrl-C has come, which the caller has to look for. Without the
  /// interpreter's lock and without holding the rack.
  void pass(base::SimDuration duration);

  /// Simulated time follows the machine's clock, `speed` times as fast, until stop_pacing().
  void start_pacing(double speed);
  void stop_pacing();
  [[nodiscard]] bool paced() const { return pacing_.load(); }

  /// Ends all threads and closes links; every later use throws.
  void close();
  [[nodiscard]] bool closed() const { return closed_.load(); }

  // While the rack is held.

  [[nodiscard]] rack::Rack& rack() { return bench_ ? bench_->rack() : *rack_; }
  [[nodiscard]] const rack::EventLog& log() const { return bench_ ? bench_->log() : *log_; }
  [[nodiscard]] const rack::RackConfiguration& configuration() const {
    return bench_ ? bench_->configuration() : configuration_;
  }
  [[nodiscard]] base::SimTime now();
  /// Throws std::runtime_error if the rack is on links, where masters are outside.
  [[nodiscard]] bench::Bench& bench();
  [[nodiscard]] bool has_links() const { return runner_ != nullptr; }
  /// The devices' threads look at once at what was done; only with links.
  void wake() const;
  /// The device of that name. Throws std::runtime_error with the nearest.
  [[nodiscard]] rack::DeviceAddress require_device(const std::string& name);
  /// All signals of the rack, in its order.
  [[nodiscard]] const std::vector<product::Signal>& all_signals();
  /// Has `guest`, as long as it lives, leave before the rack ends.
  void admit(const std::shared_ptr<Guest>& guest) { guests_.push_back(guest); }
  /// Null: nothing is recorded.
  [[nodiscard]] SignalStore* signals() { return signals_ ? &*signals_ : nullptr; }

 private:
  /// The rack, held by this thread.
  class Holding {
   public:
    explicit Holding(Session& session);
    ~Holding();
    Holding(const Holding&) = delete;
    Holding& operator=(const Holding&) = delete;

   private:
    Session& session_;
    std::unique_lock<std::mutex> lock_;
  };

  void record(const Options& options);
  /// Lets some of `remaining` pass, which it makes less; true: there is more.
  bool pass_slice(base::SimDuration& remaining);
  /// Waits some time for `end`; true: it has come.
  bool await(base::SimTime end);
  void pace(double speed);
  void keep_samples();

  rack::RackConfiguration configuration_;
  std::shared_ptr<DeviceFailure> failure_;
  std::optional<bench::Bench> bench_;
  // With links, in the order in which they need each other.
  std::unique_ptr<rack::EventLog> log_;
  std::unique_ptr<rack::Rack> rack_;
  std::unique_ptr<rack::Runner> runner_;
  std::vector<std::weak_ptr<Guest>> guests_;
  std::vector<product::Signal> all_signals_;  ///< empty until somebody asks
  std::optional<SignalStore> signals_;
  std::mutex mutex_;                 ///< of all above; threads of a runner share its own beside
  std::condition_variable changed_;  ///< somebody held the rack
  std::mutex pacing_mutex_;
  std::condition_variable pacing_ends_;
  std::thread pacing_thread_;
  std::atomic<bool> pacing_{false};
  std::atomic<bool> closed_{false};
};

/// A device of a session.
struct DeviceHandle {
  std::shared_ptr<Session> session;
  rack::DeviceAddress address;
};

}  // namespace stator::python
