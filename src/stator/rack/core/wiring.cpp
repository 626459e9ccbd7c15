#include "stator/rack/core/wiring.hpp"

namespace stator::rack {

unsigned far_port(const DeviceConfiguration& device) {
  return device.wiring.entry_port == 1 ? 0 : 1;
}

Attachment attachment_of(std::span<const DeviceConfiguration> devices, std::size_t index) {
  const WiringConfiguration& wiring = devices[index].wiring;
  if (index == 0) {
    return {std::nullopt, 0, wiring.entry_port};
  }
  const std::size_t parent = wiring.after.value_or(index - 1);
  return {parent, wiring.port.value_or(far_port(devices[parent])), wiring.entry_port};
}

std::optional<std::size_t> device_at(std::span<const DeviceConfiguration> devices,
                                     std::size_t index, unsigned port) {
  for (std::size_t i = index + 1; i < devices.size(); ++i) {
    const Attachment attachment = attachment_of(devices, i);
    if (attachment.parent == index && attachment.parent_port == port) {
      return i;
    }
  }
  return std::nullopt;
}

bool has_cable(const SegmentConfiguration& segment, std::size_t index, unsigned port) {
  const bool last = index + 1 == segment.devices.size();
  return port == segment.devices[index].wiring.entry_port ||
         device_at(segment.devices, index, port).has_value() ||
         (last && segment.redundant() && port == far_port(segment.devices[index]));
}

std::string redundancy_problem(const SegmentConfiguration& segment) {
  if (!segment.redundant()) {
    return {};
  }
  for (const link::LinkAddress& link : {segment.link, segment.redundant_link}) {
    if (!link.in_process() && link.kind != link::LinkKind::raw_ethernet) {
      return "cable redundancy needs two network interfaces, ethercat:INTERFACE each; one of the "
             "links is " +
             to_text(link);
    }
  }
  if (segment.link == segment.redundant_link) {
    return "the redundant link names " + to_text(segment.link) + " again; a ring needs two";
  }
  return {};
}

namespace {

/// Connects what is in a segment, or in a plan of one.
template <typename Network>
void connect_cables(Network& network, const SegmentConfiguration& configuration) {
  using ethercat::MasterInterface;
  using ethercat::SlavePort;
  const std::span<const DeviceConfiguration> devices = configuration.devices;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const Attachment attachment = attachment_of(devices, i);
    const base::SimDuration delay = devices[i].wiring.cable_delay;
    const SlavePort entry{i, attachment.port};
    if (attachment.parent) {
      network.connect(SlavePort{*attachment.parent, attachment.parent_port}, entry, delay);
    } else {
      network.connect(MasterInterface::primary, entry, delay);
    }
  }
  if (configuration.redundant()) {
    network.connect(MasterInterface::secondary,
                    SlavePort{devices.size() - 1, far_port(devices.back())},
                    ethercat::kDefaultCableDelay);
  }
}

}  // namespace

void connect(ethercat::Segment& segment, const SegmentConfiguration& configuration) {
  connect_cables(segment, configuration);
}

std::vector<std::size_t> frame_order(const SegmentConfiguration& segment) {
  ethercat::Wiring wiring;
  for (std::size_t i = 0; i < segment.devices.size(); ++i) {
    wiring.add_slave();
  }
  connect_cables(wiring, segment);
  std::vector<ethercat::SlaveForwarding> slaves(segment.devices.size());
  for (std::size_t i = 0; i < slaves.size(); ++i) {
    for (unsigned port = 0; port < ethercat::kPortsPerSlave; ++port) {
      const bool cable = wiring.peer({i, port}).kind != ethercat::Wiring::Peer::Kind::none;
      slaves[i].links |= static_cast<std::uint8_t>((cable ? 1U : 0U) << port);
    }
    slaves[i].open_ports = slaves[i].links;
  }
  ethercat::RoutePlanner planner;
  ethercat::Route route;
  planner.plan(wiring, slaves, ethercat::MasterInterface::primary, route);
  std::vector<std::size_t> order;
  for (const ethercat::Route::Visit& visit : route.visits) {
    order.push_back(visit.slave);
  }
  return order;
}

}  // namespace stator::rack
