// Options of sockets: any by setsockopt(), the size of the receive buffer, the receive timeout.
#pragma once

#include <algorithm>
#include <cstdint>

#include <sys/socket.h>
#include <sys/time.h>

#include "stator/base/sim_time.hpp"

namespace stator::link {

template <typename Value>
bool set_socket_option(int socket, int level, int option, const Value& value) {
  return ::setsockopt(socket, level, option, &value, sizeof value) == 0;
}

/// Makes room for about a thousand short frames while the process is not scheduled.
inline void enlarge_receive_buffer(int socket) {
  constexpr int kBytes = 1 << 20;
  // The forced variant needs CAP_NET_ADMIN; the plain one is bounded by the system's limit, which
  // is enough for a master that sends one frame per cycle.
  if (!set_socket_option(socket, SOL_SOCKET, SO_RCVBUFFORCE, kBytes)) {
    set_socket_option(socket, SOL_SOCKET, SO_RCVBUF, kBytes);
  }
}

/// How long recv() on a socket sleeps, set only when it changes.
///
/// Sleeping in recv() itself: poll() and recv() would cost a seventh of the round trips that recv()
/// alone reaches when both ends share a processor.
class SocketReceiveTimeout {
 public:
  /// False if the system refuses; errno says why.
  bool set(int socket, base::SimDuration timeout) {
    if (timeout == timeout_) {
      return true;
    }
    // 0 would mean for ever.
    const std::int64_t microseconds = std::max<std::int64_t>(timeout.nanoseconds() / 1'000, 1);
    const timeval value{.tv_sec = static_cast<time_t>(microseconds / 1'000'000),
                        .tv_usec = static_cast<suseconds_t>(microseconds % 1'000'000)};
    timeout_ = timeout;
    return set_socket_option(socket, SOL_SOCKET, SO_RCVTIMEO, value);
  }

 private:
  base::SimDuration timeout_;
};

}  // namespace stator::link
