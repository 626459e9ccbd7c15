#include "stator/link/system/host_and_port.hpp"

#include <algorithm>
#include <charconv>

#include <arpa/inet.h>

namespace stator::link {

std::optional<HostAndPort> split_host_and_port(std::string_view text) {
  HostAndPort parts;
  std::string_view rest;
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) {
      return std::nullopt;
    }
    parts.host = text.substr(1, close - 1);
    rest = text.substr(close + 1);
  } else {
    const std::size_t colon = std::min(text.find(':'), text.size());
    parts.host = text.substr(0, colon);
    rest = text.substr(colon);
  }
  if (rest.empty()) {
    return parts;
  }
  if (!rest.starts_with(':')) {
    return std::nullopt;
  }
  parts.port = rest.substr(1);
  return parts;
}

std::optional<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return port;
}

bool is_ipv4_address(const std::string& host) {
  in_addr address{};
  return ::inet_pton(AF_INET, host.c_str(), &address) == 1;
}

bool is_ip_address(const std::string& host) {
  in6_addr address{};
  return is_ipv4_address(host) || ::inet_pton(AF_INET6, host.c_str(), &address) == 1;
}

}  // namespace stator::link
