#pragma once

#include <system_error>

#include <pthread.h>

namespace stator::rack {

/// A mutex whose holder has the priority of the most urgent thread that waits for it. A thread that
/// answers frames in real time so never waits for one that the rest of the machine keeps from
/// running. Without real-time policies it is a mutex like any other.
class InheritingMutex {
 public:
  InheritingMutex() {
    pthread_mutexattr_t attributes{};
    ::pthread_mutexattr_init(&attributes);
    ::pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    if (::pthread_mutex_init(&mutex_, &attributes) != 0) {
      ::pthread_mutex_init(&mutex_, nullptr);  // a system that has no such mutexes
    }
    ::pthread_mutexattr_destroy(&attributes);
  }
  ~InheritingMutex() { ::pthread_mutex_destroy(&mutex_); }
  InheritingMutex(const InheritingMutex&) = delete;
  InheritingMutex& operator=(const InheritingMutex&) = delete;

  void lock() {
    if (const int error = ::pthread_mutex_lock(&mutex_); error != 0) {
      throw std::system_error(error, std::generic_category());
    }
  }
  bool try_lock() { return ::pthread_mutex_trylock(&mutex_) == 0; }
  void unlock() { ::pthread_mutex_unlock(&mutex_); }

 private:
  pthread_mutex_t mutex_{};
};

}  // namespace stator::rack
