#include "stator/link/can/can_link_address.hpp"

#include <array>
#include <optional>

#include <arpa/inet.h>
#include <net/if.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/host_and_port.hpp"

namespace stator::link {

namespace {

using Parsed = base::Expected<CanLinkAddress, LinkError>;

struct Form {
  std::string_view word;
  CanLinkKind kind;
};
constexpr std::array kForms{
    Form{"slcan", CanLinkKind::slcan},
    Form{"slcan-tcp", CanLinkKind::slcan_tcp},
    Form{"socketcand", CanLinkKind::socketcand},
    Form{"socketcan", CanLinkKind::socketcan},
    Form{"udp-multicast", CanLinkKind::udp_multicast},
    Form{"can-exec", CanLinkKind::can_exec},
};

base::Unexpected<LinkError> refuse(std::string_view text, const std::string& reason) {
  return fail(LinkErrorCode::invalid_option,
              "CAN port " + in_quotes(std::string(text)) + " " + reason);
}

/// "[ADDRESS:]PORT"
Parsed parse_server(std::string_view text, std::string_view rest, CanLinkAddress address) {
  const auto parts = split_host_and_port(rest);
  address.name = !parts || parts->port ? parts.value_or(HostAndPort{rest, {}}).host : kLoopback;
  if (!is_ipv4_address(address.name)) {
    return refuse(text,
                  "needs an IPv4 address of this machine in numbers before the port; 0.0.0.0 "
                  "listens at all of them, without one it is 127.0.0.1");
  }
  const auto port = parse_port(parts->port.value_or(rest));
  if (!port) {
    return refuse(text, "needs a port from 1 to 65535, or 0 for any free one");
  }
  address.port = *port;
  return address;
}

/// "[GROUP[:PORT]]"
Parsed parse_group(std::string_view text, std::string_view rest, CanLinkAddress address) {
  const HostAndPort parts = split_host_and_port(rest).value_or(HostAndPort{rest, {}});
  address.name = parts.host.empty() ? kMulticastGroup : parts.host;
  address.port = kMulticastPort;
  in_addr parsed{};
  if (::inet_pton(AF_INET, address.name.c_str(), &parsed) != 1 ||
      !IN_MULTICAST(ntohl(parsed.s_addr))) {
    return refuse(text,
                  "needs an IPv4 multicast group (224.0.0.0 to 239.255.255.255) in numbers; "
                  "without one it is 239.74.163.2, python-can's own");
  }
  if (parts.port) {
    const auto port = parse_port(*parts.port);
    if (!port || *port == 0) {
      return refuse(text, "needs a port from 1 to 65535 behind the group; without one it is 43113");
    }
    address.port = *port;
  }
  return address;
}

/// "NAME", that of an interface.
Parsed parse_interface(std::string_view text, std::string_view rest, CanLinkAddress address) {
  if (rest.empty() || rest.size() >= IF_NAMESIZE ||
      rest.find_first_of("/=: ") != std::string_view::npos) {
    return refuse(text,
                  "needs the name of an interface, at most 15 characters without blank, slash, "
                  "colon and equals sign, e.g. can0");
  }
  address.name = rest;
  return address;
}

Parsed parse_rest(std::string_view text, std::string_view rest, const CanLinkAddress& address) {
  switch (address.kind) {
    case CanLinkKind::slcan: {
      if (rest.empty()) {
        return refuse(text,
                      "needs the path under which programs open it, e.g. slcan:/tmp/stator-can0");
      }
      CanLinkAddress result = address;
      result.name = rest;
      return result;
    }
    case CanLinkKind::slcan_tcp:
      return parse_server(text, rest, address);
    case CanLinkKind::socketcand:
      return rest.empty() ? parse_server(text, std::to_string(kSocketcandPort), address)
                          : parse_server(text, rest, address);
    case CanLinkKind::udp_multicast:
      return parse_group(text, rest, address);
    case CanLinkKind::socketcan:
    case CanLinkKind::can_exec:
      return parse_interface(text, rest, address);
  }
  return address;
}

/// False if `option` is none of this kind of port.
bool take_option(std::string_view option, CanLinkAddress& address) {
  const bool slcan = address.kind == CanLinkKind::slcan || address.kind == CanLinkKind::slcan_tcp;
  if (option == "acknowledge" && slcan) {
    return address.acknowledge = true;
  }
  if (option == "beacon" && address.kind == CanLinkKind::socketcand) {
    return address.beacon = true;
  }
  return false;
}

}  // namespace

Parsed parse_can_link_address(std::string_view text) {
  std::string_view rest = text;
  const std::size_t comma = rest.find(',');
  std::string_view options =
      comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
  rest = rest.substr(0, comma);
  const std::size_t colon = rest.find(':');
  CanLinkAddress address;
  bool known = false;
  for (const Form& form : kForms) {
    if (form.word == rest.substr(0, colon)) {
      address.kind = form.kind;
      known = true;
    }
  }
  if (!known) {
    return refuse(text, "is not understood; write " + std::string(kCanLinkForms) +
                            ", e.g. slcan:/tmp/stator-can0");
  }
  while (!options.empty()) {
    const std::size_t end = options.find(',');
    if (!take_option(options.substr(0, end), address)) {
      return refuse(text,
                    "has an option it does not know; options are \",acknowledge\" of slcan "
                    "and slcan-tcp and \",beacon\" of socketcand");
    }
    options = end == std::string_view::npos ? std::string_view() : options.substr(end + 1);
  }
  return parse_rest(text, colon == std::string_view::npos ? "" : rest.substr(colon + 1), address);
}

std::string to_text(const CanLinkAddress& address) {
  std::string text;
  for (const Form& form : kForms) {
    if (form.kind == address.kind) {
      text = std::string(form.word) + ":" + address.name;
    }
  }
  if (address.kind == CanLinkKind::slcan_tcp || address.kind == CanLinkKind::socketcand ||
      address.kind == CanLinkKind::udp_multicast) {
    text += ":" + std::to_string(address.port);
  }
  text += address.acknowledge ? ",acknowledge" : "";
  text += address.beacon ? ",beacon" : "";
  return text;
}

std::string python_can_arguments(const CanLinkAddress& address) {
  const auto arguments = [](std::string_view interface, const std::string& channel) {
    return "interface=\"" + std::string(interface) + "\", channel=\"" + channel + "\"";
  };
  const std::string host = address.name == "0.0.0.0" ? std::string(kLoopback) : address.name;
  const std::string port = std::to_string(address.port);
  switch (address.kind) {
    case CanLinkKind::slcan:
      return arguments("slcan", address.name);
    case CanLinkKind::slcan_tcp:
      return arguments("slcan", "socket://" + host + ":" + port);
    case CanLinkKind::socketcand:
      return "interface=\"socketcand\", host=\"" + host + "\", port=" + port + ", channel=\"can0\"";
    case CanLinkKind::socketcan:
    case CanLinkKind::can_exec:
      return arguments("socketcan", address.name);
    case CanLinkKind::udp_multicast:
      return arguments("udp_multicast", address.name) + ", port=" + port;
  }
  return "";
}

}  // namespace stator::link
