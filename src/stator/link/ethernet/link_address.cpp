#include "stator/link/ethernet/link_address.hpp"

#include <optional>

#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/host_and_port.hpp"

namespace stator::link {

namespace {

constexpr std::string_view kInProcess = "in-process";

base::Unexpected<LinkError> refuse(std::string_view text, const std::string& reason) {
  return fail(LinkErrorCode::invalid_option, "link " + in_quotes(std::string(text)) + " " + reason);
}

base::Expected<LinkAddress, LinkError> parse_udp(std::string_view text, std::string_view rest) {
  LinkAddress address{.kind = LinkKind::udp, .name = {}, .port = kEtherCatUdpPort};
  const HostAndPort parts = split_host_and_port(rest).value_or(HostAndPort{rest, {}});
  address.name = parts.host;
  if (!is_ipv4_address(address.name)) {
    return refuse(text,
                  "needs an IPv4 address in numbers, e.g. udp:127.0.0.1; slaves listen at all "
                  "addresses of the machine with udp:0.0.0.0");
  }
  if (parts.port) {
    const auto port = parse_port(*parts.port);
    if (!port || *port == 0) {
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
