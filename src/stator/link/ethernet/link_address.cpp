#include "stator/link/ethernet/link_address.hpp"

#include <charconv>
#include <optional>

#include <arpa/inet.h>

#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr std::string_view kInProcess = "in-process";

base::Unexpected<LinkError> refuse(std::string_view text, const std::string& reason) {
  return fail(LinkErrorCode::invalid_option, "link " + in_quotes(std::string(text)) + " " + reason);
}

std::optional<std::uint16_t> parse_port(std::string_view text) {
  std::uint16_t port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (error != std::errc() || end != text.data() + text.size() || port == 0) {
    return std::nullopt;
  }
  return port;
}

base::Expected<LinkAddress, LinkError> parse_udp(std::string_view text, std::string_view rest) {
  LinkAddress address{.kind = LinkKind::udp, .name = {}, .port = kEtherCatUdpPort};
  const std::size_t colon = rest.find(':');
  address.name = rest.substr(0, colon);
  in_addr ignored{};
  if (::inet_pton(AF_INET, address.name.c_str(), &ignored) != 1) {
    return refuse(text,
                  "needs an IPv4 address in numbers, e.g. udp:127.0.0.1; slaves listen at all "
                  "addresses of the machine with udp:0.0.0.0");
  }
  if (colon != std::string_view::npos) {
    const auto port = parse_port(rest.substr(colon + 1));
    if (!port) {
      return refuse(text,
                    "needs a port from 1 to 65535 behind the address; without one it is "
                    "EtherCAT's 34980");
    }
    address.port = *port;
  }
  return address;
}

}  // namespace

base::Expected<LinkAddress, LinkError> parse_link_address(std::string_view text) {
  if (text == kInProcess) {
    return LinkAddress{};
  }
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  const std::string_view rest =
      colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  if (!rest.empty()) {
    if (kind == "ethercat") {
      return LinkAddress{.kind = LinkKind::raw_ethernet, .name = std::string(rest)};
    }
    if (kind == "tap") {
      return LinkAddress{.kind = LinkKind::tap, .name = std::string(rest)};
    }
    if (kind == "udp") {
      return parse_udp(text, rest);
    }
  }
  return refuse(text,
                "is not understood; write " + std::string(kLinkForms) + ", e.g. ethercat:eth1");
}

std::string to_text(const LinkAddress& address) {
  switch (address.kind) {
    case LinkKind::in_process:
      return std::string(kInProcess);
    case LinkKind::raw_ethernet:
      return "ethercat:" + address.name;
    case LinkKind::udp:
      return "udp:" + address.name + ":" + std::to_string(address.port);
    case LinkKind::tap:
      return "tap:" + address.name;
  }
  return {};
}

}  // namespace stator::link
