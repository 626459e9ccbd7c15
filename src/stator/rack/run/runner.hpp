#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/system/pcap_writer.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/log.hpp"
#include "stator/rack/run/bus_thread.hpp"
#include "stator/rack/run/chip_thread.hpp"
#include "stator/rack/run/eoe_bridge.hpp"
#include "stator/rack/run/master_seat.hpp"
#include "stator/rack/run/running_rack.hpp"
#include "stator/rack/run/serial_line_thread.hpp"

namespace stator::rack {

/// What one segment's thread did so far.
struct SegmentStatistics {
  std::uint64_t frames = 0;             ///< answered
  std::uint64_t frames_unanswered = 0;  ///< came, but are no EtherCAT or got lost on their way
  std::uint64_t overruns = 0;           ///< times the rack lagged behind the clock by > kOverrun
  std::int64_t worst_lag_ns = 0;        ///< longest lag seen
  std::int64_t processing_ns = 0;       ///< sum over frames from received to sent
  std::int64_t worst_processing_ns = 0;
};

/// Runs a rack on real links: one thread per segment, bus or serial line that answers what comes
/// and keeps the devices at the present moment. The frame path comes first: a frame is answered,
/// then firmware and physics catch up. With cable redundancy the thread serves both interfaces of
/// its segment. An interface without carrier is a port without link.
class Runner {
 public:
  /// Lag behind the machine's clock from which on an overrun is counted.
  static constexpr base::SimDuration kOverrun = RunningRack::kOverrun;

  /// Opens every link and capture. Throws std::runtime_error with the link's own explanation.
  /// `rack` must have been built from `configuration` and both outlive the runner. `start` is where
  /// the rack stands in simulated time. With `priority` the threads that answer what comes have
  /// that real-time priority (link::run_in_real_time), and no others.
  Runner(Rack& rack, const RackConfiguration& configuration, std::shared_ptr<Log> logger,
         base::SimTime start = {}, std::optional<int> priority = std::nullopt);
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  /// Starts the threads.
  void start();
  /// Ends the threads and waits for them; may be called twice.
  void stop();

  /// Has all threads look at once at what there is to do. From any thread.
  void wake() const;

  [[nodiscard]] base::SimTime now();
  /// Time that the machine was too slow for and that the rack will never catch up.
  [[nodiscard]] base::SimDuration lost();
  /// The same for queued tasks.
  [[nodiscard]] base::SimDuration lost_in_task() const { return shared_.lost; }
  /// Of a bus with a wire.
  [[nodiscard]] BusThread& bus(std::size_t index) { return *buses_[index]; }
  [[nodiscard]] const BusThread& bus(std::size_t index) const { return *buses_[index]; }
  [[nodiscard]] std::size_t line_count() const { return lines_.size(); }
  [[nodiscard]] SerialLineThread& line(std::size_t index) { return *lines_[index]; }
  [[nodiscard]] const SerialLineThread& line(std::size_t index) const { return *lines_[index]; }
  /// Sockets for firmware beside chips, in the order in which the devices stand in the rack.
  [[nodiscard]] std::size_t chip_count() const { return chips_.size(); }
  [[nodiscard]] ChipThread& chip(std::size_t index) { return *chips_[index]; }
  [[nodiscard]] SegmentStatistics statistics(std::size_t segment);
  /// Of a segment's master; guarded by the rack's mutex, as those of buses and lines.
  [[nodiscard]] MasterSeat& seat(std::size_t segment);
  /// What the threads share, for masters inside this process.
  [[nodiscard]] RunningRack& running() { return shared_; }
  /// Where somebody outside hands in tasks for the running rack.
  [[nodiscard]] TaskQueue& tasks() { return shared_.tasks; }
  /// What time stamps of CAN frames add to simulated time.
  [[nodiscard]] base::SimDuration epoch() const { return shared_.epoch(); }
  [[nodiscard]] ClockKind clock_kind() const { return shared_.clock_kind; }
  /// As statistics(), for queued tasks, which run while the rack is held.
  [[nodiscard]] SegmentStatistics segment_in_task(std::size_t segment) const;
  [[nodiscard]] const link::EthernetLink& link(
      std::size_t segment,
      ethercat::MasterInterface interface = ethercat::MasterInterface::primary) const;

 private:
  struct SegmentThread;
  using MasterInterface = ethercat::MasterInterface;

  void open(SegmentThread& segment, const SegmentConfiguration& configuration);
  void run(SegmentThread& segment);
  void answer(SegmentThread& segment, std::span<std::byte> frame, MasterInterface entry);
  [[nodiscard]] base::SimDuration time_to_release(const SegmentThread& segment,
                                                  base::SimTime now) const;
  void send_released(SegmentThread& segment);
  void watch_carriers(SegmentThread& segment, base::SimTime now);
  void capture(SegmentThread& segment, base::SimTime arrival, std::span<const std::byte> answer);
  void catch_up(SegmentThread& segment);
  base::SimTime arrival_of(std::span<std::byte> frame);

  RunningRack shared_;
  std::vector<std::unique_ptr<SegmentThread>> segments_;
  std::vector<std::unique_ptr<BusThread>> buses_;  ///< null without a wire
  EoeBridges eoe_bridges_;
  std::vector<std::unique_ptr<ChipThread>> chips_;
  std::vector<std::unique_ptr<SerialLineThread>> lines_;
};

}  // namespace stator::rack
