#include "stator/ethercat/segment/topology.hpp"

#include <algorithm>

namespace stator::ethercat {

namespace {

/// Where a frame goes next inside a slave, by port; the processing unit lies behind port 0.
constexpr std::array<unsigned, kPortsPerSlave> kNextPort{3, 2, 0, 1};

/// Of a frame with VLAN tag and check sequence; no frame is longer.
constexpr std::int64_t kLongestFrame = 1522;
constexpr std::int64_t kCheckSequence = 4;
/// What FIFOs of size 0 and 7 cope with between two clocks for the longest frame, ppb.
constexpr std::int64_t kSmallestFifoCopes = std::int64_t{2} * 25'000;
constexpr std::int64_t kLargestFifoCopes = std::int64_t{2} * 100'000;
constexpr std::int64_t kLargestFifo = 7;

}  // namespace

std::size_t longest_frame(unsigned fifo_size, std::int64_t difference_ppb) {
  const std::int64_t copes =
      kSmallestFifoCopes + (kLargestFifoCopes - kSmallestFifoCopes) * fifo_size / kLargestFifo;
  const std::int64_t difference = difference_ppb < 0 ? -difference_ppb : difference_ppb;
  if (difference <= copes) {
    return static_cast<std::size_t>(kLongestFrame);
  }
  return static_cast<std::size_t>(
      std::max<std::int64_t>(kLongestFrame * copes / difference - kCheckSequence, 0));
}

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
  std::int64_t sender_ppb = 0;  ///< deviation of the clock the frame is sent with
};

/// From the port at which the frame comes in to the one through which it leaves. It comes in
/// through an open port, so the search ends there at the latest.
void RoutePlanner::pass_slave(Way& way) {
  const SlaveForwarding& slave = way.slaves[way.at.slave];
  ArrivalTimes& arrivals = way.arrivals[way.at.slave];
  arrivals.port[way.at.port] = way.time;
  arrivals.ports = static_cast<std::uint8_t>(arrivals.ports | 1U << way.at.port);
  way.route.receptions.push_back(
      {way.at, way.route.visits.size(),
       longest_frame(slave.fifo_size, slave.clock_deviation_ppb - way.sender_ppb)});
  way.sender_ppb = slave.clock_deviation_ppb;
  unsigned port = way.at.port;
  do {
    if (port == 0) {
      arrivals.processing_unit = way.time;
      way.route.visits.push_back({way.at.slave, slave.marks_circulating, {}});
    }
    port = kNextPort[port];
  } while ((slave.open_ports >> port & 1U) == 0);
  way.at.port = port;
  way.time += slave.delay + slave.transmit_delay[port];
}

void RoutePlanner::plan(const Wiring& wiring, std::span<const SlaveForwarding> slaves,
                        MasterInterface interface, Route& route) {
  arrivals_.assign(slaves.size(), {});
  route.visits.clear();
  route.receptions.clear();
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
  // The loop ends because no port is entered twice: each port has one predecessor, and the first
  // has none.
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
      } else {
        // The cable is there for both ends, but the receiving one may not accept the link.
        connected = has(slaves[way.at.slave].links, way.at.port);
      }
    }
  }
  route.duration = way.time;
  for (Route::Visit& visit : route.visits) {
    visit.times = arrivals_[visit.slave];
  }
}

}  // namespace stator::ethercat
