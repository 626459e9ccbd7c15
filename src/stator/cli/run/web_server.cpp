#include "stator/cli/run/web_server.hpp"

#include <utility>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/products.hpp"

namespace stator::cli {

namespace {

std::string announcement_of(const WebOptions& options, const web::ServerConfiguration& server,
                            const std::string& address) {
  std::string text = fmt::format(
      "Web server at http://{}/, e.g. /api/v1/rack, /metrics, /openapi.json\n", address);
  if (options.token_file.empty()) {
    text += fmt::format(
        "  dashboard: http://{}/#token={}\n"
        "  reading is free on this machine; writes need \"Authorization: Bearer {}\"\n"
        "  for stator inject, clear and snapshot: export STATOR_TOKEN={}\n",
        address, server.token, server.token, server.token);
  } else if (server.address.loopback()) {
    text += fmt::format("  reading is free on this machine; writes need the token of {}\n",
                        options.token_file);
  } else {
    text += fmt::format("  all access needs the token of {}\n", options.token_file);
  }
  return text;
}

}  // namespace

OpenedWebServer open_web_server(const WebOptions& options, rack::Rack& rack,
                                const rack::RackConfiguration& configuration,
                                const rack::EventLog& log, rack::Runner& runner,
                                web::SessionControl* session, web::RackFileControl* rack_file,
                                manual::ManualControl* manual) {
  if (options.http.empty()) {
    return {};
  }
  web::ServerConfiguration server{.address = web::parse_address(options.http),
                                  .token = {},
                                  .session = session,
                                  .rack_file = rack_file,
                                  .manual = manual,
                                  .catalogue = catalogue()};
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
  std::string announcement = announcement_of(options, server, opened->address().text());
  return {std::move(opened), std::move(announcement)};
}

}  // namespace stator::cli
