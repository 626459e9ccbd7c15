#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "stator/ethercat/eoe/ethernet_port.hpp"
#include "stator/link/ethernet/tap_link.hpp"
#include "stator/rack/observe/log.hpp"
#include "stator/rack/run/running_rack.hpp"

namespace stator::rack {

/// The network behind a device's EoE: a TAP interface of this machine. A frame from the master is
/// written to it at once, behind the frame path; those of the machine are read by a thread of the
/// bridge's own.
class EoeBridge {
 public:
  /// Gets a frame of the machine, in the bridge's thread.
  using Deliver = std::function<void(std::span<const std::byte>)>;

  /// `link` must pass every EtherType; `logger` is told what goes wrong under the `device`'s name.
  EoeBridge(std::unique_ptr<link::TapLink> link, std::string device, std::shared_ptr<Log> logger,
            Deliver deliver);
  ~EoeBridge();
  EoeBridge(const EoeBridge&) = delete;
  EoeBridge& operator=(const EoeBridge&) = delete;

  void send(std::span<const std::byte> frame);
  void set_ip_parameters(const ethercat::IpParameters& parameters);

  [[nodiscard]] link::LinkStatistics link_statistics() const { return link_->statistics(); }

 private:
  void run();

  std::unique_ptr<link::TapLink> link_;
  std::string device_;
  std::shared_ptr<Log> logger_;
  Deliver deliver_;
  bool send_failure_logged_ = false;
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
  /// std::runtime_error with the link's own explanation. What is shared must outlive the bridges.
  void open(RunningRack& shared, const RackConfiguration& configuration);
  /// Disconnects the devices, which nobody may be using meanwhile, and removes the interfaces.
  void close();

 private:
  struct Connection {
    DeviceAddress device;
    std::unique_ptr<EoeBridge> bridge;
  };

  RunningRack* shared_ = nullptr;
  std::vector<Connection> connections_;
};

}  // namespace stator::rack
