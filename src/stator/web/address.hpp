#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stator::web {

/// Where the web server listens.
struct Address {
  std::string host = "127.0.0.1";  ///< an IPv4 or IPv6 address, without brackets
  std::uint16_t port = 0;          ///< 0: any that is free

  /// Only programs on this machine reach it.
  [[nodiscard]] bool loopback() const;
  /// "127.0.0.1:8080", "[::1]:8080".
  [[nodiscard]] std::string text() const;
};

/// Reads "[ADDRESS:]PORT", an IPv6 address in brackets. Throws std::runtime_error naming the form.
[[nodiscard]] Address parse_address(std::string_view text);

/// The host of a Host header field or an authority, without port and brackets and in lower case;
/// empty if `text` is none.
[[nodiscard]] std::string host_of(std::string_view text);

/// Reads a token from the first line of a file: 16 to 128 letters, digits, '-' and '_'. Throws
/// std::runtime_error naming the file and what is wrong.
[[nodiscard]] std::string read_token(const std::string& path);
/// A new one, of 32 letters and digits, from the system's randomness. Throws std::runtime_error
/// without such.
[[nodiscard]] std::string make_token();
/// Equal, in a time that does not tell where they differ.
[[nodiscard]] bool equal_tokens(std::string_view a, std::string_view b);

}  // namespace stator::web
