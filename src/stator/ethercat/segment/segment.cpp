#include "stator/ethercat/segment/segment.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace stator::ethercat {

namespace {

constexpr std::size_t kSourceMacOffset = 6;
constexpr std::byte kLocallyAdministered{0x02};
/// Preamble, start delimiter and check sequence around each frame.
constexpr std::size_t kFramingLength = 12;
constexpr std::int64_t kNanosecondsPerByte = 80;

}  // namespace

bool Segment::mark_circulating(std::span<DatagramView> datagrams) {
  for (DatagramView& datagram : datagrams) {
    if (datagram.circulating) {
      return false;
    }
    datagram.circulating = true;
  }
  return true;
}

Segment::~Segment() {
  for (const Station& station : stations_) {
    station.slave->watch_topology(nullptr);
  }
}

std::size_t Segment::append(SlaveController& slave, base::SimDuration cable_delay) {
  const std::size_t index = add(slave);
  if (index == 0) {
    connect(MasterInterface::primary, {index, 0}, cable_delay);
  } else {
    connect(SlavePort{index - 1, 1}, SlavePort{index, 0}, cable_delay);
  }
  return index;
}

std::size_t Segment::add(SlaveController& slave) {
  stations_.push_back({&slave});
  slave.watch_topology(&topology_changed_);
  reserve_plans();
  const std::size_t index = wiring_.add_slave();
  update_links();
  return index;
}

/// Room for as many slaves as stations_ has, so that planning between frames allocates nothing.
void Segment::reserve_plans() {
  const std::size_t slaves = stations_.capacity();
  forwarding_.reserve(slaves);
  planner_.reserve(slaves);
  for (Way& way : ways_) {
    way.route.visits.reserve(slaves);
    way.route.receptions.reserve(slaves * kPortsPerSlave);
    way.stops.reserve(slaves);
  }
}

void Segment::require_free(SlavePort port) const {
  const auto complain = [port](const char* what) {
    throw std::logic_error("port " + std::to_string(port.port) + " of slave " +
                           std::to_string(port.slave) + what);
  };
  if (port.slave >= stations_.size() || !stations_[port.slave].slave->has_port(port.port)) {
    complain(" does not exist");
  }
  if (has_cable(port)) {
    complain(" has a cable already");
  }
}

void Segment::connect(SlavePort a, SlavePort b, base::SimDuration cable_delay) {
  require_free(a);
  require_free(b);
  if (a == b) {
    throw std::logic_error("a cable needs two ports");
  }
  wiring_.connect(a, b, cable_delay);
  update_links();
}

void Segment::connect(MasterInterface interface, SlavePort port, base::SimDuration cable_delay) {
  require_free(port);
  if (wiring_.entry(interface)) {
    throw std::logic_error("an interface of the master has one cable");
  }
  wiring_.connect(interface, port, cable_delay);
  update_links();
}

void Segment::set_cable(SlavePort port, bool intact) {
  stations_[port.slave].cable_broken[port.port] = !intact;
  const Wiring::Peer& peer = wiring_.peer(port);
  if (peer.kind == Wiring::Peer::Kind::slave) {
    stations_[peer.slave_port.slave].cable_broken[peer.slave_port.port] = !intact;
  }
  update_links();
}

void Segment::set_carrier(MasterInterface interface, bool up) {
  carriers_[static_cast<std::size_t>(interface)] = up;
  update_links();
}

void Segment::set_power(std::size_t index, bool on) {
  Station& station = stations_[index];
  if (station.powered == on) {
    return;
  }
  station.powered = on;
  update_links();
  if (on) {
    station.slave->restore_power();
  }
}

bool Segment::has_link(SlavePort port) const {
  const Station& station = stations_[port.slave];
  const auto runs = [](const Station& one) { return one.powered && !one.held_in_reset; };
  if (!runs(station) || station.cable_broken[port.port]) {
    return false;
  }
  const Wiring::Peer& peer = wiring_.peer(port);
  switch (peer.kind) {
    case Wiring::Peer::Kind::slave:
      return runs(stations_[peer.slave_port.slave]);
    case Wiring::Peer::Kind::master:
      return carriers_[static_cast<std::size_t>(peer.interface)];
    default:
      return false;
  }
}

void Segment::update_links() {
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    for (unsigned port = 0; port < kPortsPerSlave; ++port) {
      stations_[i].slave->set_link(port, has_link({i, port}));
    }
  }
  topology_changed_ = true;
}

/// Updates links when slaves have been put into reset or released by their supply since the last
/// call.
void Segment::take_resets() {
  bool changed = false;
  for (Station& station : stations_) {
    const bool held = station.slave->held_in_reset();
    changed = std::exchange(station.held_in_reset, held) != held || changed;
  }
  if (changed) {
    update_links();
  }
}

void Segment::plan() {
  take_resets();
  topology_changed_ = false;
  ++plans_;
  forwarding_.clear();
  for (const Station& station : stations_) {
    forwarding_.push_back(station.slave->forwarding());
  }
  for (const MasterInterface entry : {MasterInterface::primary, MasterInterface::secondary}) {
    plan(entry);
  }
}

void Segment::plan(MasterInterface entry) {
  Way& way = ways_[static_cast<std::size_t>(entry)];
  planner_.plan(wiring_, forwarding_, entry, way.route);
  way.stops.clear();
  for (const Route::Visit& visit : way.route.visits) {
    way.stops.push_back({stations_[visit.slave].slave, visit.times.processing_unit, &visit.times,
                         visit.marks_circulating});
  }
  way.longest_frame = kMaximumFrameLength;
  for (const Reception& reception : way.route.receptions) {
    way.longest_frame = std::min(way.longest_frame, reception.longest_frame);
  }
}

/// A frame whose check sequence fails at the first of these receptions. The slave there marks it,
/// so that those behind count an error that is not their own.
void Segment::count_broken_frame(std::span<const Reception> receptions) {
  ReceiveError error = ReceiveError::invalid_frame;
  for (const Reception& reception : receptions) {
    stations_[reception.at.slave].slave->count_receive_error(reception.at.port, error);
    error = ReceiveError::forwarded_error;
  }
}

const Segment::Way& Segment::way(MasterInterface entry) {
  if (topology_changed_) [[unlikely]] {
    plan();
  }
  return ways_[static_cast<std::size_t>(entry)];
}

std::optional<MasterInterface> Segment::process(std::span<std::byte> frame, base::SimTime arrival,
                                                MasterInterface entry) {
  ++statistics_.frames;
  const Way& way = this->way(entry);
  std::size_t count = 0;
  DatagramCursor cursor(frame);
  while (cursor.next(datagrams_[count])) {
    ++count;
  }
  switch (cursor.error()) {
    case FrameError::none:
      break;
    case FrameError::too_short:
      ++statistics_.malformed;
      return std::nullopt;
    case FrameError::other_ether_type:
    case FrameError::other_header_type:
      return pass_foreign(frame, way);
    case FrameError::length_overrun:
    case FrameError::datagram_overrun:
      ++statistics_.malformed;
      for (const Stop& stop : way.stops) {
        stop.slave->count_malformed_frame();
      }
      break;
  }
  if (way.route.entered) {
    frame[kSourceMacOffset] |= kLocallyAdministered;
  }
  if (frame.size() > way.longest_frame || eventful_) [[unlikely]] {
    return process_with_faults(frame, arrival, entry, count);
  }
  const std::span<DatagramView> active = std::span(datagrams_).first(count);
  for (const Stop& stop : way.stops) {
    if (stop.marks_circulating && !mark_circulating(active)) [[unlikely]] {
      ++statistics_.destroyed;
      return std::nullopt;
    }
    stop.slave->process(active, {arrival, arrival + stop.processing_unit, *stop.arrivals});
  }
  for (const DatagramView& datagram : active) {
    datagram.store();
  }
  const std::optional<MasterInterface> exit = leave(way.route);
  if (!held_.empty()) [[unlikely]] {
    release_overtaken(arrival);
  }
  return exit;
}

/// Ends the way of a frame: counts it as answered or lost, and tells a slave at whose closed port
/// it ends.
std::optional<MasterInterface> Segment::leave(const Route& route) {
  ++(route.exit ? statistics_.answered : statistics_.lost);
  if (route.blocked_at) [[unlikely]] {
    stations_[route.blocked_at->slave].slave->receive_at_closed_port(route.blocked_at->port);
  }
  return route.exit;
}

/// A frame without datagrams: forwarded, or destroyed by the first slave that is told so.
std::optional<MasterInterface> Segment::pass_foreign(std::span<std::byte> frame, const Way& way) {
  ++statistics_.foreign;
  const auto destroys = [](const Stop& stop) { return stop.slave->destroys_foreign_frames(); };
  if (std::ranges::any_of(way.stops, destroys)) {
    ++statistics_.destroyed;
    return std::nullopt;
  }
  if (frame.size() > way.longest_frame || !faults_.empty()) {
    const std::optional<Interruption> interruption = interrupt(way, frame.size());
    if (interruption && !interruption->fault) {
      return std::nullopt;
    }
  }
  if (way.route.entered) {
    frame[kSourceMacOffset] |= kLocallyAdministered;
  }
  return leave(way.route);
}

base::SimDuration Segment::round_trip(std::size_t length) {
  const auto bytes = static_cast<std::int64_t>(length + kFramingLength);
  return base::SimDuration(bytes * kNanosecondsPerByte) +
         way(MasterInterface::primary).route.duration;
}

void Segment::advance(base::SimTime now) {
  for (const Station& station : stations_) {
    station.slave->advance(now);
  }
}

base::SimTime Segment::next_deadline() const {
  base::SimTime earliest = base::SimTime::never();
  for (const Station& station : stations_) {
    earliest = std::min(earliest, station.slave->next_deadline());
  }
  return earliest;
}

}  // namespace stator::ethercat
