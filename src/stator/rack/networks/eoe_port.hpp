#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "stator/ethercat/eoe/ethernet_frame_queue.hpp"
#include "stator/ethercat/eoe/ethernet_port.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::rack {

class Journal;

/// Gets the frames and IP parameters that the master sends to the network behind a device's EoE;
/// empty functions drop them. Called while the rack is held; must neither wait nor call the rack.
struct EoeOutput {
  std::function<void(std::span<const std::byte>)> frame;
  std::function<void(const ethercat::IpParameters&)> ip_parameters;
};

/// The network behind a device's EoE as the rack has it: frames that come wait until the device's
/// firmware asks for them, those of the master go out at once.
class EoePort final : public ethercat::EthernetPort {
 public:
  /// Frames that wait for the firmware before the oldest is dropped.
  static constexpr std::size_t kQueuedFrames = 64;

  explicit EoePort(DeviceAddress device) : device_(device) {}

  void connect(const EoeOutput& output) { output_ = output; }
  void set_journal(Journal* journal) { journal_ = journal; }
  /// A frame of 1 to ethercat::kMaximumEoeFrame bytes comes.
  void put(std::span<const std::byte> frame) { frames_dropped_ += queue_.push(frame) ? 0U : 1U; }
  /// Frames that nobody asked for in time.
  [[nodiscard]] std::uint64_t frames_dropped() const { return frames_dropped_; }

  void send(std::span<const std::byte> frame) override;
  [[nodiscard]] std::size_t take(std::span<std::byte> buffer) override {
    return queue_.pop(buffer);
  }
  void set_ip_parameters(const ethercat::IpParameters& parameters) override;

 private:
  DeviceAddress device_;
  EoeOutput output_;
  Journal* journal_ = nullptr;
  ethercat::EthernetFrameQueue queue_{kQueuedFrames};
  std::uint64_t frames_dropped_ = 0;
};

}  // namespace stator::rack
