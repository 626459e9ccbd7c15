#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "stator/ethercat/eoe/eoe.hpp"
#include "stator/ethercat/eoe/ethernet_frame_queue.hpp"
#include "stator/link/ethernet/tap_link.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/inheriting_mutex.hpp"

namespace spdlog {
class logger;
}

namespace stator::rack {

/// The network behind a device's EoE: a TAP interface of this machine. A frame from the master is
/// written to it at once, behind the frame path; those of the machine are read by a thread of the
/// bridge's own and wait in a bounded queue until the device's firmware asks for them.
class EoeBridge final : public ethercat::EthernetPort {
 public:
  /// Frames of the machine that wait for the firmware before the oldest is dropped.
  static constexpr std::size_t kQueuedFrames = 64;

  /// `link` must pass every EtherType; `logger` is told what goes wrong under the `device`'s name.
  EoeBridge(std::unique_ptr<link::TapLink> link, std::string device,
            std::shared_ptr<spdlog::logger> logger);
  ~EoeBridge() override;

  void send(std::span<const std::byte> frame) override;
  [[nodiscard]] std::size_t take(std::span<std::byte> buffer) override;
  void set_ip_parameters(const ethercat::IpParameters& parameters) override;

  [[nodiscard]] link::LinkStatistics link_statistics() const { return link_->statistics(); }
  /// Frames of the machine that nobody asked for in time.
  [[nodiscard]] std::uint64_t frames_dropped() const { return frames_dropped_; }

 private:
  void run();

  std::unique_ptr<link::TapLink> link_;
  std::string device_;
  std::shared_ptr<spdlog::logger> logger_;
  bool send_failure_logged_ = false;

  InheritingMutex mutex_;  ///< guards queue_
  ethercat::EthernetFrameQueue queue_{kQueuedFrames};
  std::atomic<bool> waiting_ = false;  ///< the queue is not empty: a look that costs nothing
  std::atomic<std::uint64_t> frames_dropped_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

/// All bridges of a rack.
class EoeBridges {
 public:
  EoeBridges() = default;
  ~EoeBridges() { close(); }
  EoeBridges(const EoeBridges&) = delete;
  EoeBridges& operator=(const EoeBridges&) = delete;

  /// Opens the TAP interface of every device that names one and connects them. Throws
  /// std::runtime_error with the link's own explanation. `rack` must outlive the bridges.
  void open(Rack& rack, const RackConfiguration& configuration,
            const std::shared_ptr<spdlog::logger>& logger);
  /// Disconnects the devices, which nobody may be using meanwhile, and removes the interfaces.
  void close();

 private:
  struct Connection {
    ethercat::EoeServer* server;
    std::unique_ptr<EoeBridge> bridge;
  };

  std::vector<Connection> connections_;
};

}  // namespace stator::rack
