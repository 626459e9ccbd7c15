// The web server of a running rack, and what it is configured with.
#pragma once

#include <memory>
#include <string>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/web/address.hpp"
#include "stator/web/rack_file_control.hpp"
#include "stator/web/server/server_limits.hpp"
#include "stator/web/session_control.hpp"

namespace stator::manual {
class ManualControl;
}

namespace stator::web {

struct ServerConfiguration {
  Address address;
  std::string token;  ///< empty only on loopback: nobody may write then
  ServerLimits limits{};
  SessionControl* session = nullptr;        ///< the recording of the run; outlives the server
  RackFileControl* rack_file = nullptr;     ///< where the rack came from; outlives the server
  manual::ManualControl* manual = nullptr;  ///< moves axes by hand; outlives the server
  product::Catalogue catalogue{};           ///< products whose keys it tells
};

/// Serves a running rack to browsers and programs: REST, a stream of signals, metrics. One thread,
/// which never holds the rack: all it wants of it goes over the runner's task queue, and the
/// streams' samples come through queues of fixed length.
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
  /// Answers what the rack is busy with, for half a second at most, closes all connections, ends
  /// the thread and waits for it; may be called twice. The rack should still run.
  void stop();

  /// Where it listens, with the port that was found if none was asked for.
  [[nodiscard]] const Address& address() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace stator::web
