#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/system/receive_wait.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/networks/bus_configuration.hpp"
#include "stator/rack/networks/serial_line_configuration.hpp"
#include "stator/rack/observe/trace_configuration.hpp"
#include "stator/rack/world/clock.hpp"
#include "stator/rack/world/device_configuration.hpp"
#include "stator/rack/world/rack_event.hpp"
#include "stator/rack/world/wire_configuration.hpp"

namespace stator::rack {

/// EtherCAT slaves wired together behind one link, or two with cable redundancy.
struct SegmentConfiguration {
  /// Where the master is; LinkKind::in_process = reached only from inside the process.
  link::LinkAddress link;
  /// The master's second interface, at the end of the last device; in_process = no cable
  /// redundancy.
  link::LinkAddress redundant_link;
  link::WaitMode wait = link::WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  std::optional<unsigned> cpu;           ///< processor the segment's thread is tied to
  std::string capture;  ///< pcap file of everything that crosses the link; empty = none
  std::vector<DeviceConfiguration> devices;

  [[nodiscard]] bool redundant() const { return !redundant_link.in_process(); }
};

struct RecordConfiguration {
  std::string file;
  base::SimDuration period{1'000'000};
  std::vector<std::string> signals{"*"};
};

/// Everything one process runs.
struct RackConfiguration {
  ClockKind clock = ClockKind::real;
  /// Lockstep: simulated time per process-data exchange, on a CAN bus per SYNC.
  base::SimDuration cycle{1'000'000};
  base::SimDuration step{50'000};  ///< lockstep: simulated time per other frame
  std::vector<SegmentConfiguration> segments;
  std::vector<BusConfiguration> buses;
  /// Of serial lines that devices name; one that is not here is as SerialLineConfiguration says.
  std::vector<SerialLineConfiguration> lines;
  std::optional<RecordConfiguration> record;
  std::optional<TraceConfiguration> trace;
  std::string state;  ///< directory in which devices keep what outlives power; empty = nothing kept
  std::vector<EventConfiguration> events;  ///< in any order
  std::vector<FaultConfiguration> faults;
  std::vector<WireConfiguration> wires;  ///< one at most for each input
  /// That devices were made of, e.g. EEPROM images, as the rack file names them.
  std::vector<std::string> named_files;
};

}  // namespace stator::rack
