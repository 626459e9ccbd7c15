#include "stator/link/ethernet/open_link.hpp"

#include <utility>

#include "stator/link/ethernet/raw_ethernet_link.hpp"
#include "stator/link/ethernet/tap_link.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

using Opened = base::Expected<std::unique_ptr<EthernetLink>, LinkError>;

template <typename Link>
Opened as_link(base::Expected<std::unique_ptr<Link>, LinkError> opened) {
  if (!opened) {
    return base::Unexpected{opened.error()};
  }
  return std::unique_ptr<EthernetLink>(std::move(*opened));
}

}  // namespace

Opened open_link(const LinkAddress& address, LinkEnd end, const LinkOptions& options) {
  switch (address.kind) {
    case LinkKind::raw_ethernet:
      return as_link(RawEthernetLink::open({.interface = address.name,
                                            .wait = options.wait,
                                            .spin_time = options.spin_time,
                                            .busy_poll = {}}));
    case LinkKind::udp: {
      const UdpEthernetOptions udp{.address = address.name,
                                   .port = address.port,
                                   .wait = options.wait,
                                   .spin_time = options.spin_time};
      return as_link(end == LinkEnd::slaves ? UdpEthernetLink::listen(udp)
                                            : UdpEthernetLink::connect(udp));
    }
    case LinkKind::tap:
      return as_link(TapLink::open(
          {.interface = address.name, .wait = options.wait, .spin_time = options.spin_time}));
    case LinkKind::in_process:
      break;
  }
  return fail(LinkErrorCode::invalid_option,
              "an in-process link cannot be opened; write " + std::string(kLinkForms));
}

}  // namespace stator::link
