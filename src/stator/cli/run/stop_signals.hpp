#pragma once

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <optional>
#include <thread>

#include "stator/base/sim_time.hpp"

namespace stator::cli {

/// What SIGINT, SIGTERM and SIGHUP do to a program that runs something. They are blocked in this
/// and all later threads, and a thread of their own takes them:
///
/// - before running(): there is nothing to end in order, so the program ends at once by the signal;
/// - afterwards: the first ends wait(), for the program to end in order;
/// - another one ends the program at once, by the signal (a shell sees 130 after SIGINT). One that
///   comes within kSameWish of the first is no other wish: timeout(1) sends each twice, and a
///   terminal sends to a wrapper too, which hands it on.
class StopSignals {
 public:
  static constexpr base::SimDuration kSameWish{250'000'000};

  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;
  ~StopSignals();

  /// Something is set up, or is from now on to be ended in order.
  void starting();
  void running();
  /// Returns when a signal came, SIGUSR1 came, which is what the program sends itself, or `limit`
  /// (if any) has passed; the signal, or 0. A signal that has come before counts.
  int wait(std::optional<base::SimDuration> limit);
  /// A signal came while something ran.
  [[nodiscard]] bool stopped();

 private:
  void take_signals();
  [[noreturn]] static void end_by(int signal);

  sigset_t set_{};
  std::mutex mutex_;
  std::condition_variable news_;
  bool running_ = false;
  bool ended_ = false;   ///< the thread is to end
  bool called_ = false;  ///< by SIGUSR1
  int stopped_by_ = 0;
  std::thread thread_;
};

}  // namespace stator::cli
