#include "ethercat/segment.hpp"

#include <algorithm>

namespace stator::ethercat {

namespace {

constexpr std::size_t kSourceMacOffset = 6;
constexpr std::byte kLocallyAdministered{0x02};
/// Preamble, start delimiter and check sequence around each frame.
constexpr std::size_t kFramingLength = 12;
constexpr std::int64_t kNanosecondsPerByte = 80;

}  // namespace

void Segment::append(SlaveController& slave, base::SimDuration cable_delay) {
  Station station;
  station.slave = &slave;
  station.cable_delay = cable_delay;
  if (!stations_.empty()) {
    stations_.back().slave->set_link(1, true);
  }
  stations_.push_back(station);
  slave.set_link(0, true);
  slave.set_link(1, false);
  rewire();
}

void Segment::set_link(std::size_t position, bool up) {
  stations_[position].link_up = up;
  stations_[position].slave->set_link(0, up);
  if (position > 0) {
    stations_[position - 1].slave->set_link(1, up);
  }
  rewire();
}

void Segment::rewire() {
  base::SimDuration outbound;
  base::SimDuration inbound;
  reachable_ = 0;
  leaves_segment_ = false;
  bool reached = true;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    Station& station = stations_[i];
    outbound += station.cable_delay;
    station.outbound = outbound;
    outbound += station.slave->forwarding_delay();
    inbound += station.cable_delay + station.slave->forwarding_delay();
    station.inbound = inbound;
    static_cast<void>(station.slave->take_topology_change());
    reached = reached && station.link_up;
    if (reached) {
      reachable_ = i + 1;
      const bool cable_behind = i + 1 < stations_.size() && stations_[i + 1].link_up;
      reached = station.slave->port_open(1);
      // A port forced open without a cable sends frames into nothing.
      leaves_segment_ = reached && !cable_behind;
    }
  }
}

bool Segment::process(std::span<std::byte> frame, base::SimTime arrival) {
  ++statistics_.frames;
  std::size_t count = 0;
  DatagramCursor cursor(frame);
  while (const auto datagram = cursor.next()) {
    datagrams_[count++] = *datagram;
  }
  switch (cursor.error()) {
    case FrameError::none:
      break;
    case FrameError::too_short:
      ++statistics_.malformed;
      return false;
    case FrameError::other_ether_type:
    case FrameError::other_header_type:
      ++statistics_.foreign;
      return false;
    case FrameError::length_overrun:
    case FrameError::datagram_overrun:
      ++statistics_.malformed;
      for (Station& station : std::span(stations_).first(reachable_)) {
        station.slave->count_malformed_frame();
      }
      break;
  }
  if (reachable_ == 0) {
    ++statistics_.lost;
    return false;
  }
  frame[kSourceMacOffset] |= kLocallyAdministered;

  const Station& last = stations_[reachable_ - 1];
  const base::SimTime turn = arrival + last.outbound + last.inbound;
  const std::span<DatagramView> active = std::span(datagrams_).first(count);
  const bool lost = leaves_segment_;
  bool topology_changed = false;
  for (Station& station : std::span(stations_).first(reachable_)) {
    station.slave->process(active, {arrival + station.outbound, turn - station.inbound});
    topology_changed |= station.slave->take_topology_change();
  }
  for (const DatagramView& datagram : active) {
    datagram.store();
  }
  if (topology_changed) {
    rewire();
  }
  ++(lost ? statistics_.lost : statistics_.answered);
  return !lost;
}

base::SimDuration Segment::round_trip(std::size_t length) const {
  const auto bytes = static_cast<std::int64_t>(length + kFramingLength);
  const base::SimDuration serialised(bytes * kNanosecondsPerByte);
  if (reachable_ == 0) {
    return serialised;
  }
  // From the first port out and back: the way to the last processing unit is made twice.
  const Station& last = stations_[reachable_ - 1];
  return serialised + last.outbound + last.inbound;
}

void Segment::advance(base::SimTime now) {
  bool topology_changed = false;
  for (Station& station : stations_) {
    station.slave->advance(now);
    topology_changed |= station.slave->take_topology_change();
  }
  if (topology_changed) {
    rewire();
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
