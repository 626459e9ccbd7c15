#include "stator/link/serial/serial_link.hpp"

#include <optional>
#include <utility>

#include "stator/link/serial/pty_link.hpp"
#include "stator/link/serial/tcp_serial_link.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/host_and_port.hpp"
#include "stator/link/system/tcp_listener.hpp"

namespace stator::link {

namespace {

using Parsed = base::Expected<SerialLinkAddress, LinkError>;

constexpr std::string_view kPty = "pty:";
constexpr std::string_view kTcp = "tcp:";

base::Unexpected<LinkError> refuse(std::string_view text, const std::string& reason) {
  return fail(LinkErrorCode::invalid_option,
              "serial line " + in_quotes(std::string(text)) + " " + reason);
}

/// "[ADDRESS:]PORT"
Parsed parse_tcp(std::string_view text, std::string_view rest) {
  SerialLinkAddress address{.kind = SerialLinkKind::tcp, .name = kLoopbackAddress, .port = 0};
  const auto parts = split_host_and_port(rest);
  if (!parts || parts->port) {
    address.name = parts.value_or(HostAndPort{rest, {}}).host;
  }
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

template <typename Link, typename... Arguments>
base::Expected<std::unique_ptr<SerialLink>, LinkError> open_as(const Arguments&... arguments) {
  auto opened = Link::open(arguments...);
  if (!opened) {
    return base::Unexpected{opened.error()};
  }
  return std::unique_ptr<SerialLink>(std::move(*opened));
}

}  // namespace

Parsed parse_serial_link(std::string_view text) {
  if (text.starts_with(kPty) && text.size() > kPty.size()) {
    return SerialLinkAddress{
        .kind = SerialLinkKind::pty, .name = std::string(text.substr(kPty.size())), .port = 0};
  }
  if (text.starts_with(kTcp)) {
    return parse_tcp(text, text.substr(kTcp.size()));
  }
  return refuse(text, "is not understood; write " + std::string(kSerialLinkForms) +
                          ", e.g. pty:/tmp/tmcm-142 or tcp:29142");
}

base::Expected<std::unique_ptr<SerialLink>, LinkError> open_serial_link(
    std::string_view text, const SerialLinkOptions& options) {
  const auto address = parse_serial_link(text);
  if (!address) {
    return base::Unexpected{address.error()};
  }
  return address->kind == SerialLinkKind::pty
             ? open_as<PtyLink>(address->name, options)
             : open_as<TcpSerialLink>(address->name, address->port, options);
}

}  // namespace stator::link
