#pragma once

#include <csignal>
#include <ctime>

#include <pthread.h>

namespace stator::cli {

/// Keeps Ctrl-C from ending the program; taken() tells whether it was pressed.
class Interruption {
 public:
  Interruption() {
    ::sigemptyset(&set_);
    ::sigaddset(&set_, SIGINT);
    ::pthread_sigmask(SIG_BLOCK, &set_, &before_);
  }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption() {
    static_cast<void>(taken());
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

  /// True once for each time it was pressed.
  [[nodiscard]] bool taken() const {
    constexpr timespec kNow{};
    return ::sigtimedwait(&set_, nullptr, &kNow) == SIGINT;
  }

 private:
  sigset_t set_{};
  sigset_t before_{};
};

}  // namespace stator::cli
