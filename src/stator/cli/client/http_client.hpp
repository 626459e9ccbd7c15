#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace stator::cli {

/// Where a running rack's web server is.
struct HttpAddress {
  std::string host = "127.0.0.1";
  std::string port = "8080";
};

/// Takes "http://HOST:PORT/", "HOST:PORT", ":PORT" and "PORT"; a host in brackets is an IPv6
/// address. Throws Failure for anything else.
[[nodiscard]] HttpAddress parse_http_address(const std::string& text);

struct HttpResponse {
  unsigned status = 0;
  std::string body;
};

/// A client of the interface that `stator run --http` serves, for commands that ask or change a
/// running rack. One connection is kept open and made again when the server has closed it.
class HttpClient {
 public:
  /// `token` may be empty; writes need it, and all requests from other machines.
  HttpClient(HttpAddress address, std::string token);
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;
  ~HttpClient();

  /// Waits for the answer, five seconds at most. Throws Failure if there is no server or no answer.
  [[nodiscard]] HttpResponse request(const std::string& method, const std::string& target,
                                     const std::string& body = {});
  /// The same for answers in JSON; throws Failure with the server's reason for a status from 400
  /// on.
  [[nodiscard]] nlohmann::json json(const std::string& method, const std::string& target,
                                    const std::string& body = {});

  [[nodiscard]] std::string url() const;

 private:
  class Connection;

  HttpAddress address_;
  std::string token_;
  std::unique_ptr<Connection> connection_;
};

/// The token in a file as `stator run --http-token` takes it; "" without a name. Throws Failure if
/// it cannot be read.
[[nodiscard]] std::string read_http_token(const std::string& path);

/// `text` as a part of a target: what has a meaning there is written in hexadecimal digits.
[[nodiscard]] std::string url_encoded(const std::string& text);

}  // namespace stator::cli
