#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "stator/link/serial/chip_server.hpp"
#include "stator/rack/core/host_pins.hpp"
#include "stator/rack/run/chip_session.hpp"
#include "stator/rack/run/running_rack.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/device_configuration.hpp"

namespace stator::rack {

/// What one chip's thread did so far.
struct ChipThreadStatistics {
  link::ChipServerStatistics server;
  std::uint64_t requests = 0;
  std::int64_t processing_ns = 0;  ///< sum over requests, from received to answered
  std::int64_t worst_processing_ns = 0;
};

/// Serves the firmware of one chip at a socket: a thread that sleeps until the program asks for
/// something or a line it watches changes on the clock alone. What a frame changes is told by the
/// segment's thread, as soon as the master has its answer.
///
/// With the real clock a request happens at the present moment. In lockstep it happens at the
/// master's: requests take no time, so how fast a program polls changes nothing.
class ChipThread {
 public:
  /// Opens the socket of the device. Throws std::runtime_error with the server's own explanation,
  /// or if the device has nothing to connect firmware to.
  ChipThread(RunningRack& shared, DeviceAddress device, const DeviceConfiguration& configuration);
  ~ChipThread();
  ChipThread(const ChipThread&) = delete;
  ChipThread& operator=(const ChipThread&) = delete;

  void start();
  /// Ends the thread and waits for it; may be called twice.
  void stop();
  /// Lets the thread look at once at what there is to do. From any thread.
  void wake() noexcept { server_->wake(); }

  /// What programs connect to.
  [[nodiscard]] const std::string& name() const { return server_->name(); }
  [[nodiscard]] ChipThreadStatistics statistics();

 private:
  void run();
  void take(const link::ChipMessage& message);
  [[nodiscard]] base::SimDuration time_to_sleep();
  void switch_power(bool on);

  RunningRack& shared_;
  DeviceAddress device_;
  HostPins pins_;
  std::unique_ptr<link::ChipServer> server_;
  std::optional<ChipSession> session_;
  ChipThreadStatistics statistics_;
  std::thread thread_;
};

}  // namespace stator::rack
