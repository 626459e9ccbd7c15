#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/manual/axis.hpp"
#include "stator/master/error.hpp"
#include "stator/rack/run/master_seat.hpp"
#include "stator/rack/run/running_rack.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::manual {

/// An axis of a device of the rack.
struct AxisPlace {
  rack::DeviceAddress device;
  unsigned number = 0;
  std::optional<product::MotionUnits> units{};  ///< nothing: not known
};

/// A master on one network of a running rack, as long as nobody speaks over the network's link.
/// Blocking: all but make_way() and end() runs in one thread, which must not hold the rack.
class NetworkMaster : public rack::ResidentMaster {
 public:
  /// `seat` is that of the network; both outlive the master.
  NetworkMaster(rack::RunningRack& running, rack::MasterSeat& seat)
      : running_(running), seat_(seat) {}
  ~NetworkMaster() override;

  /// Sits down as the network's master and begins, or says why that cannot be.
  master::Result<void> open();
  /// An axis of a device on the network.
  virtual master::Result<std::unique_ptr<Axis>> axis(const AxisPlace& place) = 0;
  /// Writes a device's output process data from `offset` on, for those that have no axis. They go
  /// out with the next cycle and stay.
  virtual master::Result<void> set_outputs(rack::DeviceAddress device, std::size_t offset,
                                           std::span<const std::byte> data);
  /// Lets one cycle pass: process data, or time alone.
  virtual master::Result<void> cycle() = 0;
  /// Leaves the network as it was found; the master is of no use any more.
  void close();

  /// Somebody else has spoken: nothing is sent any more.
  [[nodiscard]] bool displaced() const { return displaced_; }
  void make_way(base::SimTime now) override;
  /// Ends whatever is waited for. From any thread.
  void end();

 protected:
  /// Of networks without process data.
  static constexpr base::SimDuration kCycle{10'000'000};

  /// What a network begins with, and what it says last. The seat is taken.
  virtual master::Result<void> begin() = 0;
  virtual void finish() {}
  /// Somebody else has spoken, with the rack held.
  virtual void displace() {}

  /// Lets `duration` of the machine's time pass, less if the master ends.
  void wait(base::SimDuration duration);
  /// Nothing may be sent any more.
  [[nodiscard]] bool ended() const { return displaced_ || ending_; }
  [[nodiscard]] static master::Error why_ended();

  rack::RunningRack& running_;

 private:
  rack::MasterSeat& seat_;
  std::atomic<bool> displaced_{false};
  std::atomic<bool> ending_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
};

}  // namespace stator::manual
