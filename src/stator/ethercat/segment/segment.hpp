#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/frame_faults.hpp"
#include "stator/ethercat/segment/released_frame.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/ethercat/standard/frame.hpp"

namespace stator::ethercat {

/// What a segment has seen since its construction.
struct SegmentStatistics {
  std::uint64_t frames = 0;     ///< handed to process()
  std::uint64_t answered = 0;   ///< came out at one of the master's interfaces
  std::uint64_t foreign = 0;    ///< no EtherCAT datagrams in them: passed on or destroyed
  std::uint64_t malformed = 0;  ///< too short, or with a datagram that runs past the frame
  std::uint64_t lost = 0;       ///< ended at an open port without cable or at a closed one
  std::uint64_t torn = 0;       ///< too long for a receive FIFO between clocks that far apart
  std::uint64_t dropped = 0;    ///< by inject(): did not arrive
  std::uint64_t corrupted = 0;  ///< by inject(): arrived with wrong bits
  std::uint64_t held = 0;       ///< by inject(): arrived later than sent, copies included
  std::uint64_t destroyed = 0;  ///< circulating ones, and foreign ones the forwarding rule forbids
};

/// Slave controllers and the cables between them: a line, a tree over all four ports, or a ring
/// with the master's two interfaces at its ends. A frame is processed in place, slave by slave, as
/// it passes the processing units. Its way and the times at which it reaches each port are worked
/// out when cables, loops or delays change (RoutePlanner), so that the frame path is a flat loop.
///
/// Loop settings, links and power change between frames, as on hardware, where a port waits for the
/// end of the present frame.
class Segment {
 public:
  Segment() = default;
  ~Segment();
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  // Wiring. Not in the cyclic path: allocates. Slaves must outlive the segment. Connecting a port
  // that does not exist or has a cable already is a mistake in a declaration: std::logic_error.

  /// Attaches `slave` in line behind the one added last, port 1 to port 0; the first one gets the
  /// primary interface. Returns its index.
  std::size_t append(SlaveController& slave, base::SimDuration cable_delay = kDefaultCableDelay);
  /// Adds `slave` without a cable. Returns its index.
  std::size_t add(SlaveController& slave);
  void connect(SlavePort a, SlavePort b, base::SimDuration cable_delay = kDefaultCableDelay);
  void connect(MasterInterface interface, SlavePort port,
               base::SimDuration cable_delay = kDefaultCableDelay);

  [[nodiscard]] std::size_t size() const { return stations_.size(); }
  [[nodiscard]] SlaveController& slave(std::size_t index) { return *stations_[index].slave; }
  [[nodiscard]] const SlaveController& slave(std::size_t index) const {
    return *stations_[index].slave;
  }
  [[nodiscard]] bool has_cable(SlavePort port) const {
    return wiring_.peer(port).kind != Wiring::Peer::Kind::none;
  }

  // What happens to a segment while it runs. Both ends of a cable lose or get their link.

  /// Breaks or heals the cable at `port`.
  void set_cable(SlavePort port, bool intact);
  /// Breaks or heals the cable at port 0 of the slave with this index.
  void set_link(std::size_t index, bool up) { set_cable({index, 0}, up); }

  // Faults. What is asked for allocates; a segment without faults does not notice them.

  /// Lets a fault hit frames at a port, after those asked for earlier at the same place, and
  /// returns its number. A port without a cable, which no frame passes, is a mistake in a
  /// declaration: std::logic_error.
  std::uint64_t inject(const FrameFault& fault);
  /// Lets a slave not count datagrams; returns the fault's number.
  std::uint64_t inject(const CountFault& fault);
  /// Ends a fault of either kind. Frames that it holds go on at their time.
  void withdraw(std::uint64_t number);
  /// How often a fault has hit; nothing: as often as it should, or it was withdrawn.
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t number) const;

  /// When the next held frame goes on; never() if there is none.
  [[nodiscard]] base::SimTime next_release() const { return next_release_; }
  /// Lets frames go on whose time has come until one comes out, which gets into `buffer`
  /// (kMaximumFrameLength bytes). Nothing: none does at `now`.
  [[nodiscard]] std::optional<ReleasedFrame> release(base::SimTime now,
                                                     std::span<std::byte> buffer);

  /// Tells `observer` of every frame from now on; null ends that.
  void observe(FrameObserver* observer);

  /// The master's interface is switched on or off; at the start both are on.
  void set_carrier(MasterInterface interface, bool up);
  [[nodiscard]] bool carrier(MasterInterface interface) const {
    return carriers_[static_cast<std::size_t>(interface)];
  }
  /// Power of one slave. Off: its controller loses all state and its neighbours their links. On: it
  /// starts as after a reset and asks its firmware to do the same (take_reset_request()).
  void set_power(std::size_t index, bool on);
  [[nodiscard]] bool powered(std::size_t index) const { return stations_[index].powered; }

  /// Passes an Ethernet frame through the slaves. `arrival` is when its first bit leaves the
  /// master's interface `entry`. The frame is changed in place and keeps its length. Returns the
  /// interface at which it comes out, nothing if it is lost or destroyed.
  [[nodiscard]] std::optional<MasterInterface> process(std::span<std::byte> frame,
                                                       base::SimTime arrival,
                                                       MasterInterface entry);
  /// The same for a master with one interface, the primary: true if the frame comes back there.
  [[nodiscard]] bool process(std::span<std::byte> frame, base::SimTime arrival) {
    return process(frame, arrival, MasterInterface::primary) == MasterInterface::primary;
  }

  /// How long a frame of `length` bytes takes from its first bit at the primary interface to its
  /// last bit where it comes out, at 100 Mbit/s with preamble and check sequence.
  [[nodiscard]] base::SimDuration round_trip(std::size_t length);

  /// Brings all controllers to `now`.
  void advance(base::SimTime now);
  /// The earliest moment at which some controller wants advance() although nothing arrives.
  [[nodiscard]] base::SimTime next_deadline() const;

  [[nodiscard]] const SegmentStatistics& statistics() const { return statistics_; }

 private:
  struct Station {
    SlaveController* slave = nullptr;
    std::array<bool, kPortsPerSlave> cable_broken{};
    bool powered = true;
    bool held_in_reset = false;
  };

  /// A slave that a frame passes: what the frame path needs, close together.
  struct Stop {
    SlaveController* slave = nullptr;
    base::SimDuration processing_unit;
    const ArrivalTimes* arrivals = nullptr;
    bool marks_circulating = false;
  };
  struct Way {
    Route route;
    std::vector<Stop> stops;                          ///< the visits of the route
    std::size_t longest_frame = kMaximumFrameLength;  ///< one beyond is torn on the way
  };

  /// At a slave whose port 0 is closed for want of a link: marks a frame that passes for the first
  /// time; false for one that does so again and must not go on (ETG.1000.4 §5.4, circulating bit).
  static bool mark_circulating(std::span<DatagramView> datagrams);
  void reserve_plans();
  void require_free(SlavePort port) const;
  [[nodiscard]] bool has_link(SlavePort port) const;
  void update_links();
  void take_resets();
  [[nodiscard]] const Way& way(MasterInterface entry);
  void plan();
  void plan(MasterInterface entry);
  /// Where on its way a frame is torn or hit by a fault.
  struct Interruption {
    std::size_t passed = 0;             ///< processing units before
    std::optional<FrameFault> fault{};  ///< nothing: it is lost
  };
  [[nodiscard]] std::optional<Interruption> interrupt(const Way& way, std::size_t length);
  [[nodiscard]] std::optional<Interruption> meet(const Way& way, std::size_t reception,
                                                 std::size_t passed);
  [[nodiscard]] std::optional<MasterInterface> process_with_faults(std::span<std::byte> frame,
                                                                   base::SimTime arrival,
                                                                   MasterInterface entry,
                                                                   std::size_t datagrams);
  [[nodiscard]] bool visit(std::span<const Stop> stops, std::span<DatagramView> datagrams,
                           base::SimTime sent);
  void hold(std::span<const std::byte> frame, MasterInterface entry, base::SimTime arrival,
            const Interruption& at);
  [[nodiscard]] std::optional<MasterInterface> go_on(HeldFrame& held, base::SimTime now);
  void release_overtaken(base::SimTime now);
  void find_next_release();
  void note_faults() {
    eventful_ = !faults_.empty() || !count_faults_.empty() || observer_ != nullptr;
  }
  void count_broken_frame(std::span<const Reception> receptions);
  [[nodiscard]] std::optional<MasterInterface> leave(const Route& route);
  [[nodiscard]] std::optional<MasterInterface> pass_foreign(std::span<std::byte> frame,
                                                            const Way& way);

  std::vector<Station> stations_;
  Wiring wiring_;
  std::array<bool, kMasterInterfaces> carriers_{true, true};
  RoutePlanner planner_;
  std::vector<SlaveForwarding> forwarding_;  ///< of each slave, while planning
  std::array<Way, kMasterInterfaces> ways_;
  bool topology_changed_ = false;  ///< ways_ are out of date; slaves set it too
  bool eventful_ = false;          ///< there is a fault or an observer
  std::uint64_t plans_ = 0;        ///< made so far
  FrameFaults faults_;
  struct CountingFault {
    std::uint64_t number = 0;
    const SlaveController* slave = nullptr;
    std::uint16_t commands = 0;
    base::Recurrence recurrence;
  };
  std::vector<CountingFault> count_faults_;
  std::uint64_t newest_count_fault_ = 0;
  FrameObserver* observer_ = nullptr;
  std::vector<HeldFrame> held_;  ///< in the order in which they were caught
  base::SimTime next_release_ = base::SimTime::never();
  SegmentStatistics statistics_;
  /// Of the frame in process(), and one for the look behind the last.
  std::array<DatagramView, kMaximumDatagrams + 1> datagrams_{};
};

}  // namespace stator::ethercat
