#include "stator/link/system/receive_wait.hpp"

#include <cerrno>
#include <ctime>

#include <poll.h>

namespace stator::link {

std::int64_t monotonic_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

bool sleep_until_readable(int descriptor, base::SimDuration time) {
  pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
  const std::int64_t nanoseconds = time.nanoseconds();
  const timespec limit{nanoseconds / 1'000'000'000, nanoseconds % 1'000'000'000};
  return ::ppoll(&waiting, 1, &limit, nullptr) >= 0 || errno != EINTR;
}

}  // namespace stator::link
