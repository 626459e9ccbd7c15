#include "ethercat/topology.hpp"

namespace stator::ethercat {

namespace {

/// Where a frame goes next inside a slave, by port; the processing unit lies behind port 0.
constexpr std::array<unsigned, kPortsPerSlave> kNextPort{3, 2, 0, 1};

}  // namespace

std::size_t Wiring::add_slave() {
  peers_.emplace_back();
  return peers_.size() - 1;
}

void Wiring::connect(SlavePort a, SlavePort b, base::SimDuration cable_delay) {
  peers_[a.slave][a.port] = {Peer::Kind::slave, b, MasterInterface::primary, cable_delay};
  peers_[b.slave][b.port] = {Peer::Kind::slave, a, MasterInterface::primary, cable_delay};
}

void Wiring::connect(MasterInterface interface, SlavePort port, base::SimDuration cable_delay) {
  peers_[port.slave][port.port] = {Peer::Kind::master, {}, interface, cable_delay};
  entries_[static_cast<std::size_t>(interface)] = port;
}

/// A frame under way.
struct RoutePlanner::Way {
  std::span<const SlaveForwarding> slaves;
  std::span<ArrivalTimes> arrivals;
  Route& route;
  SlavePort at;
  base::SimDuration time;
};

/// From the port at which the frame comes in to the one through which it leaves. It comes in
/// through an open port, so the search ends there at the latest.
void RoutePlanner::pass_slave(Way& way) {
  const SlaveForwarding& slave = way.slaves[way.at.slave];
  ArrivalTimes& arrivals = way.arrivals[way.at.slave];
  arrivals.port[way.at.port] = way.time;
  arrivals.ports = static_cast<std::uint8_t>(arrivals.ports | 1U << way.at.port);
  unsigned port = way.at.port;
  do {
    if (port == 0) {
      arrivals.processing_unit = way.time;
      way.route.visits.push_back({way.at.slave, slave.marks_circulating, {}});
    }
    port = kNextPort[port];
  } while ((slave.open_ports >> port & 1U) == 0);
  way.at.port = port;
  way.time += slave.delay;
}

void RoutePlanner::plan(const Wiring& wiring, std::span<const SlaveForwarding> slaves,
                        MasterInterface interface, Route& route) {
  arrivals_.assign(slaves.size(), {});
  route.visits.clear();
  route.entered = false;
  route.exit.reset();
  route.blocked_at.reset();
  route.duration = {};
  const std::optional<SlavePort> entry = wiring.entry(interface);
  if (!entry) {
    return;
  }
  const auto has = [](std::uint8_t mask, unsigned port) { return (mask >> port & 1U) != 0; };
  Way way{slaves, arrivals_, route, *entry, wiring.peer(*entry).cable_delay};
  bool connected = has(slaves[entry->slave].links, entry->port);
  // No port is entered twice: each has one predecessor, and the first one has none.
  while (connected && !route.exit) {
    if (!has(slaves[way.at.slave].open_ports, way.at.port)) {
      route.blocked_at = way.at;
      break;
    }
    route.entered = true;
    pass_slave(way);
    connected = has(slaves[way.at.slave].links, way.at.port);
    const Wiring::Peer& peer = wiring.peer(way.at);
    if (connected) {
      way.time += peer.cable_delay;
      way.at = peer.slave_port;
      if (peer.kind == Wiring::Peer::Kind::master) {
        route.exit = peer.interface;
      }
    }
  }
  route.duration = way.time;
  for (Route::Visit& visit : route.visits) {
    visit.times = arrivals_[visit.slave];
  }
}

}  // namespace stator::ethercat
