#include "stator/cli/run/stop_signals.hpp"

#include <chrono>
#include <cstdlib>
#include <utility>

#include <pthread.h>

namespace stator::cli {

namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

StopSignals::StopSignals() {
  ::sigemptyset(&set_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGUSR1}) {
    ::sigaddset(&set_, signal);
  }
  ::pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  thread_ = std::thread([this] { take_signals(); });
}

StopSignals::~StopSignals() {
  {
    const std::scoped_lock lock(mutex_);
    ended_ = true;
  }
  ::pthread_kill(thread_.native_handle(), SIGUSR1);
  thread_.join();
}

void StopSignals::starting() {
  const std::scoped_lock lock(mutex_);
  running_ = false;
}

void StopSignals::running() {
  const std::scoped_lock lock(mutex_);
  running_ = true;
}

int StopSignals::wait(std::optional<base::SimDuration> limit) {
  std::unique_lock lock(mutex_);
  const auto came = [this] { return stopped_by_ != 0 || called_; };
  if (!limit) {
    news_.wait(lock, came);
  } else {
    news_.wait_for(lock, std::chrono::nanoseconds(limit->nanoseconds()), came);
  }
  if (stopped_by_ != 0) {
    return stopped_by_;
  }
  return std::exchange(called_, false) ? SIGUSR1 : 0;
}

bool StopSignals::stopped() {
  const std::scoped_lock lock(mutex_);
  return stopped_by_ != 0;
}

void StopSignals::take_signals() {
  Clock::time_point first;
  while (true) {
    int signal = 0;
    if (::sigwait(&set_, &signal) != 0) {
      continue;
    }
    const std::scoped_lock lock(mutex_);
    if (signal == SIGUSR1) {
      if (ended_) {
        return;
      }
      called_ = true;
    } else if (stopped_by_ != 0) {
      if (Clock::now() - first < std::chrono::nanoseconds(kSameWish.nanoseconds())) {
        continue;
      }
      end_by(signal);
    } else if (!running_) {
      end_by(signal);
    } else {
      stopped_by_ = signal;
      first = Clock::now();
    }
    news_.notify_all();
  }
}

void StopSignals::end_by(int signal) {
  static_cast<void>(std::signal(signal, SIG_DFL));  // cannot fail for one that came
  sigset_t one{};
  ::sigemptyset(&one);
  ::sigaddset(&one, signal);
  ::pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
  ::pthread_kill(::pthread_self(), signal);
  std::_Exit(128 + signal);  // reached where the signal does not end the process
}

}  // namespace stator::cli
