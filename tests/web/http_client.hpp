#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace stator::web {

/// An answer as it came over the wire.
struct Answer {
  int status = 0;                              ///< 0: the connection ended without one
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;

  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(body, nullptr, false); }
};

/// A socket of one's own that can also do what no decent client does. Holds all that the server
/// says against what it describes of itself (`Contract`): a test in which it says anything else
/// fails.
class HttpClient {
 public:
  /// `receive_buffer`: bytes that the system takes while nobody reads; 0: as many as it likes.
  explicit HttpClient(std::uint16_t port, int receive_buffer = 0);
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// False: the server has closed the connection.
  bool send(std::string_view bytes);
  /// Reads one answer; `head`: it has no body.
  Answer receive(bool head = false);
  /// Sends a request with Host and, if there is a body, its length and type.
  Answer request(const std::string& method, const std::string& target, const std::string& body = {},
                 const std::string& fields = {});
  /// The server ended the connection: nothing more comes.
  bool ended();

  // WebSocket (RFC 6455), once request() with upgrade_fields() was answered by 101.

  [[nodiscard]] static std::string upgrade_fields();
  bool send_frame(unsigned opcode, std::string_view payload, bool masked = true);
  struct Frame {
    unsigned opcode = 0;
    std::string payload;
  };
  /// Nothing: the connection ended.
  std::optional<Frame> receive_frame();
  /// The next message of that type, as JSON; null if the connection ends.
  nlohmann::json receive_message(const std::string& type);

 private:
  bool fill();
  Answer read_answer(bool head);

  std::uint16_t port_;
  int socket_ = -1;
  std::string buffer_;
  std::string method_;  ///< of the newest request; empty: what was sent begins like none
  std::string target_;
};

}  // namespace stator::web
