#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/sim_time.hpp"
#include "ethercat/frame.hpp"
#include "ethercat/slave_controller.hpp"

namespace stator::ethercat {

/// What a segment has seen since its construction.
struct SegmentStatistics {
  std::uint64_t frames = 0;     ///< handed to process()
  std::uint64_t answered = 0;   ///< sent back to the master
  std::uint64_t foreign = 0;    ///< other EtherType or EtherCAT header type: not answered
  std::uint64_t malformed = 0;  ///< too short, or with a datagram that runs past the frame
  std::uint64_t lost = 0;       ///< left through an open port without a cable
};

/// Slave controllers wired in line: the master at port 0 of the first, port 1 of each to port 0 of
/// the next. A frame is processed in place, slave by slave, as it passes the processing units. The
/// times at which it reaches each port are prefix sums made once, when the wiring changes, so that
/// the frame path is a flat loop.
class Segment {
 public:
  Segment() = default;
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  /// Attaches `slave` behind the last one with a cable of `cable_delay` in between. The slave must
  /// outlive the segment. Not in the cyclic path: allocates.
  void append(SlaveController& slave, base::SimDuration cable_delay = base::SimDuration(10));

  [[nodiscard]] std::size_t size() const { return stations_.size(); }
  [[nodiscard]] SlaveController& slave(std::size_t position) { return *stations_[position].slave; }

  /// Breaks (`up` false) or heals the cable in front of the slave at `position`.
  void set_link(std::size_t position, bool up);

  /// Passes an Ethernet frame through the slaves and back. `arrival` is when its first bit reaches
  /// the first cable. True if the frame, changed in place and of the same length, comes back to the
  /// master; false if it is to be dropped.
  [[nodiscard]] bool process(std::span<std::byte> frame, base::SimTime arrival);

  /// How long a frame of `length` bytes takes from its first bit at the master's port to its last
  /// bit back there, at 100 Mbit/s with preamble and check sequence.
  [[nodiscard]] base::SimDuration round_trip(std::size_t length) const;

  /// Brings all controllers to `now`.
  void advance(base::SimTime now);
  /// The earliest moment at which some controller wants advance() although nothing arrives.
  [[nodiscard]] base::SimTime next_deadline() const;

  [[nodiscard]] const SegmentStatistics& statistics() const { return statistics_; }

 private:
  struct Station {
    SlaveController* slave = nullptr;
    base::SimDuration outbound;  ///< from the first cable to port 0 of this slave
    base::SimDuration inbound;   ///< sum of forwarding and cable delays up to this slave
    bool link_up = true;         ///< cable in front of this slave
    base::SimDuration cable_delay;
  };

  void rewire();

  std::vector<Station> stations_;
  std::size_t reachable_ = 0;    ///< slaves a frame passes
  bool leaves_segment_ = false;  ///< the last of them keeps its port 1 open without a cable
  SegmentStatistics statistics_;
  std::array<DatagramView, kMaximumDatagrams> datagrams_{};  ///< of the frame in process()
};

}  // namespace stator::ethercat
