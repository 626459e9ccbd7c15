#include "cli/rack_client.hpp"

#include <chrono>
#include <cstdlib>
#include <string_view>

#include <CLI/CLI.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/failure.hpp"
#include "web/address.hpp"

namespace stator::cli {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::string_view kScheme = "http://";
constexpr std::chrono::seconds kPatience{10};
constexpr unsigned kNotFound = 404;
constexpr unsigned kUnauthorized = 401;
constexpr unsigned kFirstError = 400;

}  // namespace

void add_client_options(CLI::App& command, RackClientOptions& options) {
  command
      .add_option("--http", options.url, "Where the rack's web server is: URL or [ADDRESS:]PORT")
      ->capture_default_str();
  command.add_option("--http-token", options.token_file,
                     "File with its token; else the variable STATOR_TOKEN");
}

RackClient::RackClient(const RackClientOptions& options) : url_(options.url) {
  std::string place = url_.starts_with(kScheme) ? url_.substr(kScheme.size()) : url_;
  while (place.ends_with('/')) {
    place.pop_back();
  }
  const std::size_t colon = place.rfind(':');
  const bool only_port =
      !place.empty() && place.find_first_not_of("0123456789") == std::string::npos;
  if (only_port) {
    host_ = "127.0.0.1";
    port_ = place;
  } else if (colon != std::string::npos && colon + 1 < place.size() && colon != 0) {
    host_ = place.substr(0, colon);
    port_ = place.substr(colon + 1);
  } else {
    throw Failure(fmt::format(
        "--http is \"{}\"; write the address and port that \"stator run --http\" printed, e.g. "
        "http://127.0.0.1:8080",
        url_));
  }
  if (host_.starts_with('[') && host_.ends_with(']')) {
    host_ = host_.substr(1, host_.size() - 2);
  }
  if (!options.token_file.empty()) {
    token_ = web::read_token(options.token_file);
  } else if (const char* token = std::getenv("STATOR_TOKEN")) {  // NOLINT(concurrency-mt-unsafe)
    token_ = token;
  }
}

RackClient::Reply RackClient::exchange(const std::string& method, const std::string& target,
                                       const std::string& body) const {
  asio::io_context context;
  beast::tcp_stream stream(context);
  http::request<http::string_body> request{http::string_to_verb(method), target, 11};
  request.set(http::field::host, host_.find(':') == std::string::npos ? host_ + ":" + port_
                                                                      : "[" + host_ + "]:" + port_);
  request.set(http::field::connection, "close");
  if (!token_.empty()) {
    request.set(http::field::authorization, "Bearer " + token_);
  }
  if (!body.empty()) {
    request.set(http::field::content_type, "application/json");
    request.body() = body;
  }
  request.prepare_payload();

  beast::flat_buffer buffer;
  http::response<http::string_body> response;
  beast::error_code failure;
  bool connected = false;
  asio::ip::tcp::resolver resolver(context);
  const auto places = resolver.resolve(host_, port_, failure);
  if (!failure) {
    // Asynchronous inside, because only that has a time limit.
    stream.expires_after(kPatience);
    stream.async_connect(places, [&](beast::error_code refused, const auto& /*place*/) {
      failure = refused;
      connected = !refused;
      if (!connected) {
        return;
      }
      http::async_write(stream, request, [&](beast::error_code lost, std::size_t) {
        failure = lost;
        if (lost) {
          return;
        }
        http::async_read(stream, buffer, response,
                         [&](beast::error_code ended, std::size_t) { failure = ended; });
      });
    });
    context.run();
  }
  if (failure) {
    throw Failure(
        connected
            ? fmt::format("the rack's web server at {} does not answer: {}", url_,
                          failure.message())
            : fmt::format("no rack is served at {}: {}; start one with \"stator run RACK --http "
                          "8080\", or name the address it printed with --http",
                          url_, failure.message()));
  }
  return {response.result_int(), std::move(response.body())};
}

nlohmann::json RackClient::request(const std::string& method, const std::string& target,
                                   const std::string& body) const {
  const Reply reply = exchange(method, target, body);
  auto json = nlohmann::json::parse(reply.body, nullptr, false);
  if (reply.status < kFirstError) {
    if (json.is_discarded()) {
      throw Failure(fmt::format("what answers at {} is no rack of stator", url_));
    }
    return json;
  }
  if (reply.status == kUnauthorized) {
    throw Failure(fmt::format(
        "the rack at {} wants its token: name the file with --http-token, or put what \"stator "
        "run\" printed into the variable STATOR_TOKEN",
        url_));
  }
  throw Failure(json.is_object() && json.contains("detail")
                    ? json["detail"].get<std::string>()
                    : fmt::format("the server at {} refused with status {}; is it a rack of this "
                                  "version of stator?",
                                  url_, reply.status));
}

nlohmann::json RackClient::get(const std::string& target) const {
  return request("GET", target, "");
}

nlohmann::json RackClient::get_if_there(const std::string& target) const {
  const Reply reply = exchange("GET", target, "");
  return reply.status == kNotFound ? nlohmann::json() : request("GET", target, "");
}

nlohmann::json RackClient::post(const std::string& target, const nlohmann::json& body) const {
  return request("POST", target, body.dump());
}

nlohmann::json RackClient::remove(const std::string& target) const {
  return request("DELETE", target, "");
}

}  // namespace stator::cli
