#pragma once

#include <atomic>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

namespace stator::cli {

/// Says on standard error how far something is that takes longer than two seconds, and how long it
/// will take: one line, which is gone at the end. Silent where standard error is no terminal that
/// can take back what it shows.
class Progress {
 public:
  /// `what` is done: "replaying run.stator".
  explicit Progress(std::string what);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  /// `part`, 0 to 1, is done. Until the first call only the time that has passed is shown. Cheap.
  void reached(double part) { part_.store(part, std::memory_order_relaxed); }
  /// Takes the line away, so that something else can be printed; it comes again.
  void clear();

  /// "replaying run.stator: 40 %, 6 s left", after `seconds`; `part` below 0: it is not known.
  [[nodiscard]] static std::string text(const std::string& what, double part, double seconds);

 private:
  void show(const std::stop_token& over);

  std::string what_;
  std::atomic<double> part_{-1.0};
  std::mutex mutex_;  ///< of the line
  bool shown_ = false;
  std::jthread thread_;  ///< goes first
};

}  // namespace stator::cli
