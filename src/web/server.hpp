#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "rack/runner.hpp"
#include "web/address.hpp"

namespace stator::web {

/// What a client may cost. The defaults let a hostile one occupy some megabytes.
struct ServerLimits {
  std::size_t connections = 64;       ///< further ones are refused
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

struct ServerConfiguration {
  Address address;
  std::string token;  ///< empty only on loopback: nobody may write then
  ServerLimits limits{};
};

/// Serves a running rack to browsers and programs: REST, a stream of signals, metrics. One thread,
/// which never holds the rack: all it wants of it goes over the runner's desk, and the streams'
/// samples come through queues of fixed length.
class Server {
 public:
  /// Listens at once; connections wait for start(). Throws std::runtime_error when that fails or if
  /// a token is missing. Everything must outlive the server's last start(). To be made before the
  /// runner is started and destroyed after it is stopped, since the rack then has tasks of it.
  Server(const ServerConfiguration& configuration, rack::Rack& rack,
         const rack::RackConfiguration& rack_configuration, const rack::EventLog& log,
         rack::Runner& runner);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void start();
  /// Closes all connections, ends the thread and waits for it; may be called twice.
  void stop();

  /// Where it listens, with the port that was found if none was asked for.
  [[nodiscard]] const Address& address() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stator::web
