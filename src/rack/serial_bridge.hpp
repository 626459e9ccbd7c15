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

#include "link/serial_link.hpp"
#include "rack/rack.hpp"
#include "tmcl/serial_port.hpp"

namespace spdlog {
class logger;
}

namespace stator::rack {

/// The cable between a device's serial interface and a serial line of this machine. A thread of the
/// bridge's own reads the line; the bytes wait in a bounded queue until the device's firmware asks
/// for them. What the device sends is written at once.
class SerialBridge final : public tmcl::SerialPort {
 public:
  /// Bytes that wait for the firmware; what comes beyond them is dropped, as by a UART.
  static constexpr std::size_t kQueuedBytes = 4096;

  /// `logger` is told what goes wrong under the `device`'s name.
  SerialBridge(std::unique_ptr<link::SerialLink> link, std::string device,
               std::shared_ptr<spdlog::logger> logger);
  ~SerialBridge() override;

  [[nodiscard]] std::size_t take(std::span<std::byte> buffer) override;
  void send(std::span<const std::byte> bytes) override;

  /// Bytes that the firmware did not fetch in time.
  [[nodiscard]] std::uint64_t bytes_dropped() const { return bytes_dropped_; }

 private:
  void run();
  void queue(std::span<const std::byte> bytes);

  std::unique_ptr<link::SerialLink> link_;
  std::string device_;
  std::shared_ptr<spdlog::logger> logger_;
  bool send_failure_logged_ = false;

  std::mutex mutex_;  ///< guards queue_, first_, queued_
  std::array<std::byte, kQueuedBytes> queue_{};
  std::size_t first_ = 0;
  std::size_t queued_ = 0;
  std::atomic<bool> waiting_ = false;  ///< the queue is not empty: a look that costs nothing
  std::atomic<std::uint64_t> bytes_dropped_ = 0;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

/// All serial bridges of a rack.
class SerialBridges {
 public:
  SerialBridges() = default;
  ~SerialBridges() { close(); }
  SerialBridges(const SerialBridges&) = delete;
  SerialBridges& operator=(const SerialBridges&) = delete;

  /// Opens the serial line of every device that names one and connects them. Throws
  /// std::runtime_error with the line's own explanation. `rack` must outlive the bridges.
  void open(Rack& rack, const RackConfiguration& configuration,
            const std::shared_ptr<spdlog::logger>& logger);
  /// Some device has a serial line, whose requests should not wait long.
  [[nodiscard]] bool any() const { return !connections_.empty(); }
  /// Disconnects the devices, which nobody may be using meanwhile, and removes the lines.
  void close();

 private:
  struct Connection {
    devices::Device& device;
    std::string interface;
    std::unique_ptr<SerialBridge> bridge;
  };

  void open(const DeviceConfiguration& configuration, devices::Device& device,
            const std::shared_ptr<spdlog::logger>& logger);

  std::vector<Connection> connections_;
};

}  // namespace stator::rack
