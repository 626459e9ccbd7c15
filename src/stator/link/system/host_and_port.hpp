#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stator::link {

/// A place in a network as people write it, cut in two; both parts view the text.
struct HostAndPort {
  std::string_view host;                 ///< without the brackets of an IPv6 address
  std::optional<std::string_view> port;  ///< nothing: none was written
};

/// "HOST", "HOST:PORT", "[HOST]" or "[HOST]:PORT". A host with colons needs the brackets. Nothing:
/// a bracket is not closed, or something else follows it.
[[nodiscard]] std::optional<HostAndPort> split_host_and_port(std::string_view text);

/// A number from 0 to 65535 without sign or blanks; nothing: `text` is none.
[[nodiscard]] std::optional<std::uint16_t> parse_port(std::string_view text);

/// An address in numbers.
[[nodiscard]] bool is_ipv4_address(const std::string& host);
[[nodiscard]] bool is_ip_address(const std::string& host);

}  // namespace stator::link
