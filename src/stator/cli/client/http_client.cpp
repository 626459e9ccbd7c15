#include "stator/cli/client/http_client.hpp"

#include <chrono>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/failure.hpp"

namespace stator::cli {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;

constexpr std::chrono::seconds kPatience{5};

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

HttpAddress parse_http_address(const std::string& text) {
  std::string_view rest = text;
  constexpr std::string_view kScheme = "http://";
  if (rest.starts_with(kScheme)) {
    rest.remove_prefix(kScheme.size());
  }
  if (const std::size_t path = rest.find('/'); path != std::string_view::npos) {
    rest = rest.substr(0, path);
  }
  HttpAddress address;
  if (is_port(rest)) {
    address.port = rest;
    return address;
  }
  const std::size_t bracket = rest.find(']');
  const std::size_t colon = rest.find(':', bracket == std::string_view::npos ? 0 : bracket);
  std::string_view host = rest.substr(0, colon);
  if (colon != std::string_view::npos) {
    address.port = rest.substr(colon + 1);
  }
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
  }
  if (!host.empty()) {
    address.host = host;
  }
  if (rest.empty() || rest.find("://") != std::string_view::npos || !is_port(address.port)) {
    throw Failure(
        fmt::format("\"{}\" is no address of a web server; write what \"stator run\" "
                    "prints, e.g. http://127.0.0.1:8080",
                    text));
  }
  return address;
}

class HttpClient::Connection {
 public:
  explicit Connection(const HttpAddress& address) : stream_(context_) {
    asio::ip::tcp::resolver resolver(context_);
    beast::error_code error;
    const auto endpoints = resolver.resolve(address.host, address.port, error);
    if (!error) {
      stream_.expires_after(kPatience);
      stream_.async_connect(endpoints,
                            [&error](beast::error_code result, const auto&) { error = result; });
      run();
    }
    if (error) {
      throw Failure(
          fmt::format("no web server at {}:{}: {}; start the rack with \"stator run "
                      "RACK --http {}\"",
                      address.host, address.port, error.message(), address.port));
    }
  }

  /// Nothing if the server has closed the connection.
  std::optional<HttpResponse> exchange(const http::request<http::string_body>& request) {
    beast::error_code error;
    stream_.expires_after(kPatience);
    http::async_write(stream_, request,
                      [&error](beast::error_code result, std::size_t) { error = result; });
    run();
    http::response_parser<http::string_body> parser;
    parser.body_limit(std::uint64_t{64} << 20U);
    if (!error) {
      http::async_read(stream_, buffer_, parser,
                       [&error](beast::error_code result, std::size_t) { error = result; });
      run();
    }
    if (error == beast::error::timeout) {
      throw Failure("the web server does not answer; the rack may hang, see its log");
    }
    if (error) {
      return std::nullopt;
    }
    open_ = parser.get().keep_alive();
    return HttpResponse{parser.get().result_int(), std::move(parser.get().body())};
  }

  [[nodiscard]] bool open() const { return open_; }

 private:
  void run() {
    context_.restart();
    context_.run();
  }

  asio::io_context context_{1};
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  bool open_ = true;
};

HttpClient::HttpClient(HttpAddress address, std::string token)
    : address_(std::move(address)), token_(std::move(token)) {}

HttpClient::~HttpClient() = default;

std::string HttpClient::url() const {
  const bool ipv6 = address_.host.find(':') != std::string::npos;
  return fmt::format("http://{}{}{}:{}", ipv6 ? "[" : "", address_.host, ipv6 ? "]" : "",
                     address_.port);
}

HttpResponse HttpClient::request(const std::string& method, const std::string& target,
                                 const std::string& body) {
  http::request<http::string_body> request;
  request.method_string(method);
  request.target(target);
  request.version(11);
  request.set(http::field::host, url().substr(std::string_view("http://").size()));
  request.set(http::field::user_agent, "stator");
  request.keep_alive(true);
  if (!token_.empty()) {
    request.set(http::field::authorization, "Bearer " + token_);
  }
  if (!body.empty()) {
    request.set(http::field::content_type, "application/json");
    request.body() = body;
  }
  request.prepare_payload();
  const bool fresh = connection_ == nullptr;
  if (fresh) {
    connection_ = std::make_unique<Connection>(address_);
  }
  std::optional<HttpResponse> response = connection_->exchange(request);
  // A server may close a connection that was idle; what changes something is not sent twice.
  if (!response && !fresh && method == "GET") {
    connection_ = std::make_unique<Connection>(address_);
    response = connection_->exchange(request);
  }
  if (!response || !connection_->open()) {
    connection_.reset();
  }
  if (!response) {
    throw Failure(
        fmt::format("{} has closed the connection without an answer; see its log", url()));
  }
  return std::move(*response);
}

nlohmann::json HttpClient::json(const std::string& method, const std::string& target,
                                const std::string& body) {
  const HttpResponse response = request(method, target, body);
  nlohmann::json document = nlohmann::json::parse(response.body, nullptr, false);
  if (response.status >= 400) {
    const bool explained = document.is_object() && document.contains("detail");
    throw Failure(fmt::format(
        "{} {} answered {}: {}", url(), target, response.status,
        explained ? document["detail"].get<std::string>() : "this is no server of a rack"));
  }
  if (document.is_discarded()) {
    throw Failure(fmt::format("{} {} answered something that is no JSON; it is no server of a rack",
                              url(), target));
  }
  return document;
}

std::string read_http_token(const std::string& path) {
  if (path.empty()) {
    return {};
  }
  std::ifstream file(path);
  std::string token;
  if (!(file >> token)) {
    throw Failure(
        fmt::format("cannot read a token from {}; check the path and its permissions", path));
  }
  return token;
}

std::string url_encoded(const std::string& text) {
  constexpr std::string_view kPlain = "-._~*,";
  std::string encoded;
  for (const char letter : text) {
    const bool word = (letter >= '0' && letter <= '9') || (letter >= 'A' && letter <= 'Z') ||
                      (letter >= 'a' && letter <= 'z');
    if (word || kPlain.find(letter) != std::string_view::npos) {
      encoded += letter;
    } else {
      encoded += fmt::format("%{:02X}", static_cast<unsigned char>(letter));
    }
  }
  return encoded;
}

}  // namespace stator::cli
