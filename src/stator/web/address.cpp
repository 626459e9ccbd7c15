#include "stator/web/address.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/random.h>

#include "stator/link/system/host_and_port.hpp"

namespace stator::web {

namespace {

constexpr std::size_t kShortestToken = 16;
constexpr std::size_t kLongestToken = 128;
constexpr std::uint32_t kLoopbackNetwork = 127;

bool is_token_letter(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9') || letter == '-' || letter == '_';
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
  if (const auto port = link::parse_port(text)) {
    address.port = *port;
    return address;
  }
  const auto parts = link::split_host_and_port(text);
  const auto port = parts && parts->port ? link::parse_port(*parts->port) : std::nullopt;
  if (port && link::is_ip_address(std::string(parts->host))) {
    address.host = parts->host;
    address.port = *port;
    return address;
  }
  throw std::runtime_error(
      fmt::format("\"{}\" is no place for a web server; write PORT, ADDRESS:PORT or [ADDRESS]:PORT "
                  "with an IPv4 "
                  "or IPv6 address, e.g. 8080 or 0.0.0.0:8080",
                  text));
}

std::string host_of(std::string_view text) {
  const auto parts = link::split_host_and_port(text);
  if (!parts || (parts->port && !parts->port->empty() && !link::parse_port(*parts->port))) {
    return {};
  }
  std::string lower(parts->host);
  std::ranges::transform(lower, lower.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return lower;
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
