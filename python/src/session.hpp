// A rack of the package: on a bench, or in real time on links, and who may touch it.
#pragma once

#include <any>
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

#include "device_behaviour.hpp"
#include "recording.hpp"
#include "signal_store.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/bench/bench.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/replay/recorded_files.hpp"
#include "stator/replay/session_recorder.hpp"

namespace stator::python {

/// Simulated seconds as a duration. Throws std::runtime_error, with `what`, for those that are
/// negative, not finite or beyond 292 years.
[[nodiscard]] base::SimDuration duration_of(double seconds, const char* what);

/// Somebody in a rack who has a place on it, which he has to leave before it ends, or who knows
/// something of it. The rack is held whenever he is called.
class Guest {
 public:
  Guest() = default;
  Guest(const Guest&) = delete;
  Guest& operator=(const Guest&) = delete;
  virtual ~Guest() = default;
  /// Gives the place back.
  virtual void leave() {}
  /// Gives it back since the rack is brought to another moment; recall() follows.
  virtual void step_aside() {}
  /// What he knows at a moment of the rack.
  [[nodiscard]] virtual std::any remember() const = 0;
  /// The rack was brought back to a moment: of that is `memory`; without a value he came later.
  /// `past` has the places on buses as they were then.
  virtual void recall(const std::any& memory, bench::Bench::Past& past) = 0;
};

/// A moment of a rack that is recorded, to which it can be brought back.
struct Moment {
  std::string name;
  base::SimTime time;
  std::string recording;  ///< file with a mark of that name
  const void* session = nullptr;
  std::shared_ptr<const bench::Bench::Memory> masters{};
  std::vector<std::pair<std::weak_ptr<Guest>, std::any>> guests{};
  std::shared_ptr<const std::string> kept_file{};  ///< has `recording` stay, if nobody asked for it
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
    std::string recording;    ///< file in which all is recorded from power-on; empty: none
    bool rewindable = false;  ///< is recorded for rewind() even if nobody names a file
    std::shared_ptr<DeviceFailure> failure;  ///< of devices in Python; never null
  };

  /// Builds the rack that `source` and `configuration` describe. Throws std::runtime_error for what
  /// cannot be built, opened or recorded.
  Session(Source source, rack::RackConfiguration configuration, const Options& options);
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

  /// Ends all threads, links and the recording; every later use throws. Returns why the recording
  /// is not complete; empty if it is or there is none.
  std::string close();
  [[nodiscard]] bool closed() const { return closed_.load(); }

  // While the rack is held.

  /// Records all that is done to the rack from now on into a file at `path`. Throws
  /// std::runtime_error if something was done to it already, or the file cannot be written.
  void record(const std::string& path);
  /// Gives the present moment of the recording a name. Throws std::runtime_error if there is no
  /// recording, it has ended, or the name is taken.
  void mark(const std::string& name);
  /// The present moment, for rewind(); empty `name`: one is made. Throws std::runtime_error if the
  /// rack is on links, or as mark() does.
  [[nodiscard]] Moment snapshot(std::string name);
  /// Brings the rack back to `moment`: builds it anew and plays its recording up to there. What
  /// follows is recorded in a further file. Throws std::runtime_error if it cannot be: the rack
  /// then is as it was, or closed, as the text says.
  void rewind(const Moment& moment);
  /// Ends the recording; the rack goes on. Throws std::runtime_error if there is none, or it is not
  /// complete.
  void end_recording();
  /// File of the recording that somebody asked for, even if it has ended; empty: there is none.
  [[nodiscard]] std::string recording() const {
    return recorder_ && !folder_ ? recorder_->path() : "";
  }
  /// Changes when the rack was made anew: what referred to parts of it is to be looked for again.
  [[nodiscard]] std::uint64_t generation() const { return generation_; }

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
  /// The signal of that name. Throws std::runtime_error if there is none.
  [[nodiscard]] const product::Signal& require_signal(const std::string& name);
  /// All signals of the rack, in its order.
  [[nodiscard]] const std::vector<product::Signal>& all_signals();
  /// Has `guest`, as long as it lives, leave before the rack ends.
  void admit(const std::shared_ptr<Guest>& guest);
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

  class Replayed;

  void sample();
  void begin_recording(const std::string& path);
  /// Has the file of the recording go when neither this nor a moment needs it, unless somebody
  /// asked for it.
  void keep_file();
  /// Ends it and waits for the disk; returns why it is not complete, else nothing.
  std::string finish_recording();
  /// Lets some of `remaining` pass, which it makes less; true: there is more.
  bool pass_slice(base::SimDuration& remaining);
  /// Waits some time for `end`; true: it has come.
  bool await(base::SimTime end);
  void pace(double speed);
  void keep_samples();

  Source source_;
  std::vector<std::string> sampled_;  ///< patterns of the signals that are recorded for NumPy
  base::SimDuration sampling_period_;
  std::optional<replay::TemporaryFolder> folder_;  ///< of recordings that nobody asked for
  std::uint64_t generation_ = 0;
  std::uint64_t moments_ = 0;  ///< those without a name so far
  rack::RackConfiguration configuration_;
  std::shared_ptr<DeviceFailure> failure_;
  Untouched untouched_;  ///< the journal of a rack without a recording
  std::optional<bench::Bench> bench_;
  // With links, in the order in which they need each other.
  std::unique_ptr<rack::EventLog> log_;
  std::unique_ptr<rack::Rack> rack_;
  std::optional<replay::SessionRecorder> recorder_;
  bool recording_ = false;                        ///< the recorder has not ended
  std::shared_ptr<const std::string> kept_file_;  ///< see keep_file()
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
