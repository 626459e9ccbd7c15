#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/sim_time.hpp"
#include "devices/tmcm_3315/tmcm_3315.hpp"
#include "link/link_address.hpp"
#include "link/receive_wait.hpp"

namespace stator::rack {

enum class ClockKind : std::uint8_t {
  real,      ///< simulated time follows the machine's clock
  lockstep,  ///< simulated time moves only with the master's frames
};

/// Configuration of one product; a further product is a further alternative.
using ProductConfiguration = std::variant<devices::Tmcm3315Configuration>;

struct DeviceConfiguration {
  std::string name;  ///< unique within the rack; prefix of its signals
  ProductConfiguration product;
  std::string eoe_interface{};  ///< TAP interface its EoE is bridged to; empty = no EoE
};

/// EtherCAT slaves wired in line behind one link.
struct SegmentConfiguration {
  /// Where the master is; LinkKind::in_process = reached only from inside the process.
  link::LinkAddress link;
  link::WaitMode wait = link::WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
  std::optional<unsigned> cpu;           ///< processor the segment's thread is tied to
  std::string capture;  ///< pcap file of everything that crosses the link; empty = none
  std::vector<DeviceConfiguration> devices;
};

struct RecordConfiguration {
  std::string file;
  base::SimDuration period{1'000'000};
  std::vector<std::string> signals{"*"};
};

/// Everything one process runs.
struct RackConfiguration {
  ClockKind clock = ClockKind::real;
  base::SimDuration cycle{1'000'000};  ///< lockstep: simulated time per process-data exchange
  base::SimDuration step{50'000};      ///< lockstep: simulated time per other frame
  std::vector<SegmentConfiguration> segments;
  std::optional<RecordConfiguration> record;
};

}  // namespace stator::rack
