// Opens the port of a CAN bus that a text such as "slcan:PATH" names, whichever class serves it.
#include "stator/link/can/can_exec_link.hpp"
#include "stator/link/can/can_link.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/can/can_tcp_link.hpp"
#include "stator/link/can/slcan_pty_link.hpp"
#include "stator/link/can/socketcan_link.hpp"
#include "stator/link/can/udp_multicast_link.hpp"

namespace stator::link {

base::Expected<std::unique_ptr<CanLink>, LinkError> open_can_link(std::string_view text,
                                                                  const CanLinkOptions& options) {
  const auto address = parse_can_link_address(text);
  if (!address) {
    return base::Unexpected{address.error()};
  }
  switch (address->kind) {
    case CanLinkKind::slcan:
      return SlcanPtyLink::open(address->name, address->acknowledge, options);
    case CanLinkKind::slcan_tcp:
    case CanLinkKind::socketcand:
      return CanTcpLink::open(*address, options);
    case CanLinkKind::socketcan:
      return SocketCanLink::open(address->name);
    case CanLinkKind::udp_multicast:
      return UdpMulticastLink::open(*address, options.epoch);
    case CanLinkKind::can_exec:
      return CanExecLink::open(address->name, options);
  }
  return base::Unexpected{LinkError{}};
}

}  // namespace stator::link
