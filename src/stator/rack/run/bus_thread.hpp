#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "stator/can/port.hpp"
#include "stator/link/can/can_link.hpp"
#include "stator/link/system/descriptor_wait.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/run/master_seat.hpp"
#include "stator/rack/run/running_rack.hpp"

namespace stator::rack {

/// What one bus's thread did so far.
struct BusThreadStatistics {
  std::uint64_t frames_in = 0;   ///< from programs onto the bus
  std::uint64_t frames_out = 0;  ///< from the bus to ports
  std::uint64_t overruns = 0;    ///< times the rack lagged behind the clock by > kOverrun
  std::int64_t worst_lag_ns = 0;
};

/// Runs one CAN bus of a rack on its ports: a thread that sleeps until a program has sent something
/// or until something happens on the bus on its own.
///
/// With the real clock a frame is put onto the bus when it comes, and what the bus carries goes out
/// to the ports when its time has come. In lockstep each frame that comes moves time: a SYNC by one
/// cycle, every other frame by the step, and further until the bus is idle, so that answers pass.
class BusThread {
 public:
  using FramePredicate = std::function<bool(const can::Frame&)>;

  /// Opens every port. Throws std::runtime_error with the link's own explanation.
  BusThread(RunningRack& shared, std::size_t index, const BusConfiguration& configuration);
  ~BusThread();
  BusThread(const BusThread&) = delete;
  BusThread& operator=(const BusThread&) = delete;

  void start();
  /// Ends the thread and waits for it; may be called twice.
  void stop();

  /// Lets the thread look again at when something happens on the bus. From any thread.
  void wake() noexcept { wait_.wake(); }

  [[nodiscard]] BusThreadStatistics statistics();
  /// For queued tasks, which run while the rack is held.
  [[nodiscard]] const BusThreadStatistics& statistics_in_task() const { return statistics_; }
  /// Guarded by the rack's mutex.
  [[nodiscard]] MasterSeat& seat() { return seat_; }
  /// Keeps the next frame that `is_answer` picks from the programs behind the ports, if it is on
  /// the bus until `until`: the answer to a resident master that has made way, for which none of
  /// them has asked. Guarded by the rack's mutex.
  void withhold(const FramePredicate& is_answer, base::SimTime until);
  [[nodiscard]] std::size_t ports() const { return ports_.size(); }
  [[nodiscard]] const link::CanLink& port(std::size_t index) const { return *ports_[index]->link; }

 private:
  /// Frames taken from a link at once: as many as a port of the bus has room for.
  using Batch = std::array<can::Frame, can::Port::kTransmitBuffer>;

  struct Withheld {
    FramePredicate is_answer;
    base::SimTime until;
  };
  struct OutsidePort {
    std::unique_ptr<link::CanLink> link;
    std::optional<BusPort> port;
    std::vector<Withheld> withheld{};
    bool minded = true;  ///< the thread wakes when it can be read
    bool to_flush = false;
    bool failed = false;
  };

  void run();
  [[nodiscard]] bool take_frames();
  [[nodiscard]] std::size_t look_at(OutsidePort& port);
  [[nodiscard]] std::size_t receive(OutsidePort& port, std::span<can::Frame> frames);
  void put_in_lockstep(OutsidePort& port, std::span<const can::Frame> frames);
  void catch_up();
  void hand_out();
  void drain();
  [[nodiscard]] static bool withholds(OutsidePort& port, const can::TimedFrame& entry);
  [[nodiscard]] base::SimDuration time_to_sleep();

  RunningRack& shared_;
  std::size_t index_;
  std::optional<unsigned> cpu_;
  std::vector<std::unique_ptr<OutsidePort>> ports_;
  link::DescriptorWait wait_;
  base::SimTime now_;  ///< of the last look
  BusThreadStatistics statistics_;
  MasterSeat seat_;
  std::thread thread_;
};

}  // namespace stator::rack
