#include "stator/web/address.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/random.h>

namespace stator::web {

namespace {

constexpr std::size_t kShortestToken = 16;
constexpr std::size_t kLongestToken = 128;
constexpr std::uint32_t kLoopbackNetwork = 127;

bool is_token_letter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
}

bool parse_port(std::string_view text, std::uint16_t& port) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, port);
  return !text.empty() && result.ec == std::errc() && result.ptr == end;
}

/// Splits "HOST[:PORT]", "[HOST][:PORT]". False: `text` is none.
bool split(std::string_view text, std::string_view& host, std::string_view& port) {
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) {
      return false;
    }
    host = text.substr(1, close - 1);
    port = text.substr(close + 1);
  } else {
    const std::size_t colon = std::min(text.find(':'), text.size());
    host = text.substr(0, colon);
    port = text.substr(colon);
  }
  if (port.empty()) {
    return true;
  }
  if (!port.starts_with(':')) {
    return false;
  }
  port.remove_prefix(1);
  return true;
}

}  // namespace

bool Address::loopback() const {
  in_addr four{};
  if (::inet_pton(AF_INET, host.c_str(), &four) == 1) {
    return ntohl(four.s_addr) >> 24U == kLoopbackNetwork;
  }
  in6_addr six{};
  return ::inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six) != 0;
}

std::string Address::text() const {
  return host.find(':') == std::string::npos ? fmt::format("{}:{}", host, port)
                                             : fmt::format("[{}]:{}", host, port);
}

Address parse_address(std::string_view text) {
  Address address;
  std::string_view host;
  std::string_view port;
  if (parse_port(text, address.port)) {
    return address;
  }
  if (split(text, host, port) && parse_port(port, address.port) &&
      is_ip_address(std::string(host))) {
    address.host = host;
    return address;
  }
  throw std::runtime_error(
      fmt::format("\"{}\" is no place for a web server; write PORT, ADDRESS:PORT or [ADDRESS]:PORT "
                  "with an IPv4 "
                  "or IPv6 address, e.g. 8080 or 0.0.0.0:8080",
                  text));
}

std::string host_of(std::string_view text) {
  std::string_view host;
  std::string_view port;
  std::uint16_t number = 0;
  if (!split(text, host, port) || (!port.empty() && !parse_port(port, number))) {
    return {};
  }
  std::string lower(host);
  std::ranges::transform(lower, lower.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return lower;
}

bool is_ip_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return ::inet_pton(AF_INET, host.c_str(), address.data()) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), address.data()) == 1;
}

std::string read_token(const std::string& path) {
  std::ifstream file(path);
  std::string token;
  if (!file || !std::getline(file, token)) {
    throw std::runtime_error(fmt::format(
        "the token file {} cannot be read: {}", path,
        errno == 0 ? std::string("it is empty") : std::generic_category().message(errno)));
  }
  while (!token.empty() && (token.back() == '\r' || token.back() == ' ')) {
    token.pop_back();
  }
  if (token.size() < kShortestToken || token.size() > kLongestToken ||
      !std::ranges::all_of(token, is_token_letter)) {
    throw std::runtime_error(
        fmt::format("the first line of the token file {} is no token: {} to {} letters, digits, "
                    "\"-\" and \"_\"; make one with: openssl rand -hex 16",
                    path, kShortestToken, kLongestToken));
  }
  return token;
}

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the system gives no randomness for the web server's token");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

bool equal_tokens(std::string_view a, std::string_view b) {
  unsigned difference = a.size() == b.size() ? 0U : 1U;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const char other = b.empty() ? '\0' : b[i % b.size()];
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(other);
  }
  return difference == 0;
}

}  // namespace stator::web
