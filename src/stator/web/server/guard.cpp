#include "stator/web/server/guard.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/link/system/host_and_port.hpp"
#include "stator/web/address.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

constexpr std::string_view kTokenProtocol = "token.";

std::string machine_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? host_of(name.data()) : std::string();
}

/// Calls `look` with each element of a comma-separated field until it returns true.
template <typename Look>
bool any_element(std::string_view list, Look look) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(','), list.size());
    std::string_view element = list.substr(0, end);
    list.remove_prefix(std::min(end + 1, list.size()));
    element.remove_prefix(std::min(element.find_first_not_of(" \t"), element.size()));
    element = element.substr(0, element.find_last_not_of(" \t") + 1);
    if (look(element)) {
      return true;
    }
  }
  return false;
}

bool is_bearer(std::string_view scheme) {
  constexpr std::string_view kBearer = "bearer ";
  return std::ranges::equal(scheme, kBearer, [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

}  // namespace

Guard::Guard(bool loopback, std::string token)
    : loopback_(loopback), token_(std::move(token)), machine_(loopback ? "" : machine_name()) {}

bool Guard::known_host(const std::string& host) const {
  if (host == "localhost") {
    return true;
  }
  if (link::is_ip_address(host)) {
    // Unlike a name, an address cannot be made by an attacker to lead here. A server on loopback
    // answers to loopback addresses only.
    return !loopback_ || Address{host, 0}.loopback();
  }
  return !machine_.empty() && host == machine_;
}

std::optional<Response> Guard::check_source(const Request& request) const {
  if (!request.host) {
    return problem(400, "a request needs one Host header field");
  }
  if (!known_host(host_of(*request.host))) {
    return problem(421, fmt::format("this server is not \"{}\"; name it by its address or as "
                                    "localhost",
                                    *request.host));
  }
  if (request.origin && *request.origin != "http://" + *request.host) {
    return problem(403, fmt::format("pages of \"{}\" have no access here; only this server's own "
                                    "have",
                                    *request.origin));
  }
  if (request.fetch_site && *request.fetch_site != "same-origin" && *request.fetch_site != "none") {
    return problem(403, "pages of other sites have no access here; type the address instead");
  }
  return std::nullopt;
}

std::optional<Response> Guard::check_token(const Request& request, bool writes, bool open) const {
  if (open || (loopback_ && !writes)) {
    return std::nullopt;
  }
  constexpr std::size_t kSchemeLength = 7;
  const std::string field = request.authorization.value_or("");
  const std::string_view authorization(field);
  if (!token_.empty() && is_bearer(authorization.substr(0, kSchemeLength)) &&
      equal_tokens(authorization.substr(kSchemeLength), token_)) {
    return std::nullopt;
  }
  if (!token_.empty() && request.websocket_protocol &&
      any_element(*request.websocket_protocol, [this](std::string_view offered) {
        return offered.starts_with(kTokenProtocol) &&
               equal_tokens(offered.substr(kTokenProtocol.size()), token_);
      })) {
    return std::nullopt;
  }
  Response response =
      problem(401, fmt::format("{} needs the token which \"stator run\" printed or was given; send "
                               "it as \"Authorization: Bearer TOKEN\"",
                               writes ? "a change" : "access from other machines"));
  response.headers.emplace_back("WWW-Authenticate", "Bearer realm=\"stator\"");
  return response;
}

std::string_view Guard::chosen_protocol(const Request& request) {
  std::string_view chosen;
  if (request.websocket_protocol) {
    any_element(*request.websocket_protocol, [&chosen](std::string_view element) {
      const auto found = std::ranges::find(kStreamProtocols, element);
      chosen = found != kStreamProtocols.end() ? *found : std::string_view();
      return !chosen.empty();
    });
  }
  return chosen;
}

}  // namespace stator::web
