#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stator::web {

/// An HTTP request as the server's library has read it.
struct Request {
  std::string method;  ///< in capitals
  std::string target;  ///< as it came: path, perhaps "?" and a query
  std::string body;
  // Header fields that matter here; nothing: it has none of that name, or one named twice.
  std::optional<std::string> host;
  std::optional<std::string> origin;
  std::optional<std::string> authorization;
  std::optional<std::string> content_type;
  std::optional<std::string> if_none_match;
  std::optional<std::string> accept_encoding;
  std::optional<std::string> fetch_site;          ///< Sec-Fetch-Site
  std::optional<std::string> websocket_protocol;  ///< Sec-WebSocket-Protocol
};

struct Response {
  unsigned status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers{};
};

}  // namespace stator::web
