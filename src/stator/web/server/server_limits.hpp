#pragma once

#include <chrono>
#include <cstddef>

namespace stator::web {

/// What a client may cost. The defaults let a hostile one occupy some megabytes.
struct ServerLimits {
  /// When there are so many, the one that has been idle longest gives way to the next; where all
  /// are at work, the next is refused.
  std::size_t connections = 64;
  std::size_t streams = 8;            ///< WebSockets among them
  std::size_t header_bytes = 8192;    ///< of a request, with its first line
  std::size_t body_bytes = 65536;     ///< of a request
  std::size_t message_bytes = 16384;  ///< that a WebSocket's client sends
  /// For a request to come in full, or an answer to be taken in full; also how long a connection
  /// may be idle.
  std::chrono::milliseconds request_time{10'000};
  /// How long a WebSocket may be silent; halfway it is asked for a sign of life.
  std::chrono::milliseconds stream_idle_time{30'000};
  /// For the rack's threads to do what was asked for.
  std::chrono::milliseconds rack_time{2'000};
};

}  // namespace stator::web
