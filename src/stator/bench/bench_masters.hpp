#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "stator/bench/bench.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/networks/serial_line.hpp"

namespace stator::bench {

// What a bench has on each network of its rack; for its own sources.

/// A frame that is not back when the next cycle begins is lost, as for masters of real machines.
[[nodiscard]] inline master::MasterOptions master_options(const rack::RackConfiguration& rack) {
  master::MasterOptions options;
  options.cycle_time = rack.cycle;
  options.frame_timeout = std::max(rack.cycle - rack.step, base::SimDuration(1));
  // Nobody here is busy: what a scenario has taken away does not come.
  options.patience = base::SimDuration();
  return options;
}

struct Bench::SegmentMaster {
  SegmentMaster(Bench& bench, std::size_t segment)
      : port(*bench.rack_, segment, bench.clock_),
        master(port, master_options(bench.configuration_)) {}

  LocalPort port;
  master::Master master;
  bool scanned = false;
  std::uint64_t lost_before = 0;  ///< cycles that had failed when the last deed began

  [[nodiscard]] std::uint64_t lost() const {
    const master::CycleStatistics& cycles = master.cycle_statistics();
    return cycles.lost + cycles.working_counter_errors;
  }
  /// What has been fetched since the last deed began, by position.
  std::vector<std::pair<std::size_t, master::Emergency>> emergencies{};
  std::set<std::size_t> mailboxes{};  ///< positions whose mailbox was started since the scan
};

struct Bench::BusMaster {
  BusMaster(rack::Rack& rack, std::size_t bus, rack::LockstepClock& clock)
      : port(rack, bus, clock) {}

  LocalCanPort port;
  std::deque<can::TimedFrame> frames{};
  std::uint64_t forgotten = 0;
  std::uint64_t before = 0;  ///< frames that had come when the last deed began

  [[nodiscard]] std::uint64_t total() const { return forgotten + frames.size(); }
};

struct Bench::LineMaster {
  LineMaster(rack::Rack& rack, std::size_t number) : index(number) { connect(rack); }
  void connect(rack::Rack& rack) {
    rack.connect_line(index, rack::SerialLine::Output::bind<&LineMaster::hear>(*this));
  }
  void hear(std::span<const std::byte> bytes) {
    heard.insert(heard.end(), bytes.begin(), bytes.end());
  }

  std::size_t index;
  std::vector<std::byte> heard{};
};

/// Everything that the masters of a bench know and that has not come from the rack's configuration.
struct Bench::Memory {
  struct Segment {
    std::unique_ptr<master::Master> master;  ///< on the port of the one that is remembered
    bool scanned = false;
    std::uint64_t lost_before = 0;
    std::vector<std::pair<std::size_t, master::Emergency>> emergencies;
    std::set<std::size_t> mailboxes;
    std::deque<std::vector<std::byte>> late;
  };
  struct Bus {
    std::deque<can::TimedFrame> frames;
    std::uint64_t forgotten = 0;
    std::uint64_t before = 0;
  };

  rack::LockstepClock clock;
  std::uint64_t events_before = 0;
  std::vector<Segment> segments{};
  std::vector<Bus> buses{};
  std::vector<std::vector<std::byte>> lines{};
};

}  // namespace stator::bench
