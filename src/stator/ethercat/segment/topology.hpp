#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/forwarding.hpp"

namespace stator::ethercat {

/// A network interface of the master. One with cable redundancy has two: the primary at the head of
/// a ring of slaves, the secondary at its tail.
enum class MasterInterface : std::uint8_t { primary, secondary };
inline constexpr std::size_t kMasterInterfaces = 2;

/// Of a cable of which nothing else is said: two metres.
inline constexpr base::SimDuration kDefaultCableDelay{10};

/// One end of a cable at a slave.
struct SlavePort {
  std::size_t slave = 0;  ///< in the order in which slaves were added
  unsigned port = 0;      ///< 0..3
  friend bool operator==(const SlavePort&, const SlavePort&) = default;
};

/// Which port is connected to which. Fixed as long as nobody plugs a cable into another port.
class Wiring {
 public:
  /// What is at the other end of a port's cable.
  struct Peer {
    enum class Kind : std::uint8_t { none, slave, master };
    Kind kind = Kind::none;
    SlavePort slave_port;                                  ///< of Kind::slave
    MasterInterface interface = MasterInterface::primary;  ///< of Kind::master
    base::SimDuration cable_delay;
  };

  std::size_t add_slave();
  /// Both ends must be free.
  void connect(SlavePort a, SlavePort b, base::SimDuration cable_delay);
  void connect(MasterInterface interface, SlavePort port, base::SimDuration cable_delay);

  [[nodiscard]] std::size_t slave_count() const { return peers_.size(); }
  [[nodiscard]] const Peer& peer(SlavePort port) const { return peers_[port.slave][port.port]; }
  /// Where the cable of a master's interface ends; nothing if it has none.
  [[nodiscard]] std::optional<SlavePort> entry(MasterInterface interface) const {
    return entries_[static_cast<std::size_t>(interface)];
  }

 private:
  std::vector<std::array<Peer, kPortsPerSlave>> peers_;
  std::array<std::optional<SlavePort>, kMasterInterfaces> entries_;
};

/// A frame comes in at a port: what its receive FIFO makes of it.
struct Reception {
  SlavePort at;
  std::size_t visits = 0;  ///< processing units passed before
  /// Bytes of a frame without its check sequence; a longer one is torn, because the FIFO runs
  /// empty or over while the clocks of sender and receiver drift apart.
  std::size_t longest_frame = 0;
};

/// Longest frame (as in Reception) that a receive FIFO of this size (0..7, register 0x0102) copes
/// with when the clocks of both ends differ by so much. By the document (TMC8670 L1419) frames of
/// 1522 bytes need clocks of 100 ppm at size 7 and of 25 ppm at size 0, each against the nominal
/// frequency: twice that between two. In between and with the length in proportion (F-126).
[[nodiscard]] std::size_t longest_frame(unsigned fifo_size, std::int64_t difference_ppb);

/// The way a frame takes from one of the master's interfaces: the processing units it passes, in
/// order, and where it ends.
struct Route {
  struct Visit {
    std::size_t slave = 0;
    bool marks_circulating = false;
    ArrivalTimes times;
  };
  std::vector<Visit> visits;
  std::vector<Reception> receptions;    ///< in order
  bool entered = false;                 ///< the first slave takes the frame
  std::optional<MasterInterface> exit;  ///< nothing: the frame is lost on the way
  std::optional<SlavePort> blocked_at;  ///< lost because this port is closed
  base::SimDuration duration;           ///< first bit from the master to the end of the way
};

/// Works out routes, so that the wiring is walked once per change and not once per frame.
///
/// Inside a slave a frame goes from port 0 through the processing unit to port 3, then 1, then 2
/// and back to port 0 (ETG.1000.4 §4.2); it leaves at the first open port on the way and comes back
/// there when what is behind it has been passed. A slave entered through another port therefore
/// forwards the frame unprocessed until it comes in through port 0, or finds port 0 closed.
class RoutePlanner {
 public:
  /// Makes room for plans of so many slaves.
  void reserve(std::size_t slaves) { arrivals_.reserve(slaves); }

  /// Fills `route` for frames from `interface`; `slaves` by index as in `wiring`. Allocates nothing
  /// if planner and route have room.
  void plan(const Wiring& wiring, std::span<const SlaveForwarding> slaves,
            MasterInterface interface, Route& route);

 private:
  struct Way;
  static void pass_slave(Way& way);

  std::vector<ArrivalTimes> arrivals_;  ///< of each slave, while planning
};

}  // namespace stator::ethercat
