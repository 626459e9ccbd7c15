#pragma once

#include <memory>
#include <string>

#include "stator/manual/manual_control.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/web/server/server.hpp"

namespace stator::cli {

/// What of the web server is asked for on the command line.
struct WebOptions {
  std::string http;        ///< "[ADDRESS:]PORT"; empty: no server
  std::string token_file;  ///< empty: the token below, on loopback only
  std::string token;       ///< empty: a new one
};

struct OpenedWebServer {
  std::unique_ptr<web::Server> server;  ///< null: none was asked for
  std::string announcement;             ///< lines that say how to reach it
};

/// Opens the server that was asked for. `session` is the recording of the run, null without one;
/// `rack_file` where its rack came from;
/// `manual` moves its axes by hand, null if nothing does.
/// Throws Failure or std::runtime_error.
[[nodiscard]] OpenedWebServer open_web_server(const WebOptions& options, rack::Rack& rack,
                                              const rack::RackConfiguration& configuration,
                                              const rack::EventLog& log, rack::Runner& runner,
                                              web::SessionControl* session,
                                              web::RackFileControl* rack_file,
                                              manual::ManualControl* manual);

}  // namespace stator::cli
