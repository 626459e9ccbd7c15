#include "cli/web_server.hpp"

#include <fmt/format.h>

#include "cli/failure.hpp"

namespace stator::cli {

std::unique_ptr<web::Server> open_web_server(const WebOptions& options, rack::Rack& rack,
                                             const rack::RackConfiguration& configuration,
                                             const rack::EventLog& log, rack::Runner& runner,
                                             web::SessionControl* session) {
  if (options.http.empty()) {
    return nullptr;
  }
  web::ServerConfiguration server{
      .address = web::parse_address(options.http), .token = {}, .session = session};
  if (!options.token_file.empty()) {
    server.token = web::read_token(options.token_file);
  } else if (server.address.loopback()) {
    server.token = options.token.empty() ? web::make_token() : options.token;
  } else {
    throw Failure(fmt::format(
        "a web server at {} is open to other machines and needs a token of yours: name its file "
        "with --http-token, or listen at 127.0.0.1",
        server.address.text()));
  }
  auto opened = std::make_unique<web::Server>(server, rack, configuration, log, runner);
  const std::string address = opened->address().text();
  fmt::print("Web server at http://{}/, e.g. /api/v1/rack, /metrics, /openapi.json\n", address);
  if (options.token_file.empty()) {
    fmt::print("  dashboard: http://{}/#token={}\n", address, server.token);
    fmt::print("  reading is free on this machine; writes need \"Authorization: Bearer {}\"\n",
               server.token);
  } else if (server.address.loopback()) {
    fmt::print("  reading is free on this machine; writes need the token of {}\n",
               options.token_file);
  } else {
    fmt::print("  all access needs the token of {}\n", options.token_file);
  }
  return opened;
}

}  // namespace stator::cli
