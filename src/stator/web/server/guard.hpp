#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "stator/web/message.hpp"

namespace stator::web {

/// Who may do what. On loopback everybody on this machine may read, elsewhere only who has the
/// token; nobody writes without it.
class Guard {
 public:
  /// `token` may be empty only on loopback and means that nobody writes.
  Guard(bool loopback, std::string token);

  /// The answer to a request that is refused for where it comes from: a Host that is not this
  /// server (DNS rebinding), or a page of another origin. Nothing: it may pass.
  [[nodiscard]] std::optional<Response> check_source(const Request& request) const;

  /// The answer to one that lacks the token. Nothing: it may pass. `writes`: it changes something;
  /// `open`: everybody may have this.
  [[nodiscard]] std::optional<Response> check_token(const Request& request, bool writes,
                                                    bool open) const;

  /// The subprotocol to choose of those a WebSocket client offers; empty: it offers none of ours.
  [[nodiscard]] static std::string_view chosen_protocol(const Request& request);

 private:
  [[nodiscard]] bool known_host(const std::string& host) const;

  bool loopback_;
  std::string token_;
  std::string machine_;  ///< its host name, by which others may call it
};

/// The subprotocols of WebSockets, for signals and for traffic. Browsers, which cannot add header
/// fields to a WebSocket, offer the token beside one of them, as "token.TOKEN".
inline constexpr std::array<std::string_view, 2> kStreamProtocols{"stator.signals.v1",
                                                                  "stator.traffic.v1"};

}  // namespace stator::web
