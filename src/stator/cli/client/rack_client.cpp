#include "stator/cli/client/rack_client.hpp"

#include <cstdlib>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/web/address.hpp"

namespace stator::cli {

namespace {

constexpr unsigned kNotFound = 404;
constexpr unsigned kUnauthorized = 401;
constexpr unsigned kFirstError = 400;

std::string token_of(const RackClientOptions& options) {
  if (!options.token_file.empty()) {
    return web::read_token(options.token_file);
  }
  const char* token = std::getenv("STATOR_TOKEN");  // NOLINT(concurrency-mt-unsafe)
  return token == nullptr ? "" : token;
}

}  // namespace

void add_client_options(CLI::App& command, RackClientOptions& options) {
  command
      .add_option("--http", options.url, "Where the rack's web server is: URL or [ADDRESS:]PORT")
      ->capture_default_str();
  command
      .add_option("--http-token", options.token_file,
                  "File with its token; else the variable STATOR_TOKEN")
      ->check(names(Names::file));
}

RackClient::RackClient(const RackClientOptions& options)
    : client_(parse_http_address(options.url), token_of(options)) {}

nlohmann::json RackClient::request(const std::string& method, const std::string& target,
                                   const std::string& body) {
  const HttpResponse reply = client_.request(method, target, body);
  auto json = nlohmann::json::parse(reply.body, nullptr, false);
  if (reply.status < kFirstError) {
    if (json.is_discarded()) {
      throw Failure(fmt::format("what answers at {} is no rack of stator", client_.url()));
    }
    return json;
  }
  if (reply.status == kUnauthorized) {
    throw Failure(fmt::format(
        "the rack at {} wants its token: name the file with --http-token, or put what \"stator "
        "run\" printed into the variable STATOR_TOKEN",
        client_.url()));
  }
  throw Failure(json.is_object() && json.contains("detail")
                    ? json["detail"].get<std::string>()
                    : fmt::format("the server at {} refused with status {}; is it a rack of this "
                                  "version of stator?",
                                  client_.url(), reply.status));
}

nlohmann::json RackClient::get(const std::string& target) {
  return request("GET", target, "");
}

nlohmann::json RackClient::get_if_there(const std::string& target) {
  const HttpResponse reply = client_.request("GET", target);
  return reply.status == kNotFound ? nlohmann::json() : request("GET", target, "");
}

nlohmann::json RackClient::post(const std::string& target, const nlohmann::json& body) {
  return request("POST", target, body.dump());
}

nlohmann::json RackClient::put(const std::string& target) {
  return request("PUT", target, "");
}

nlohmann::json RackClient::remove(const std::string& target) {
  return request("DELETE", target, "");
}

}  // namespace stator::cli
