#pragma once

#include <deque>
#include <memory>
#include <string>

#include <linux/can.h>

#include "stator/link/can/can_link.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// A CAN interface of the kernel (vcan, or a real adapter), through a raw socket. The port hears
/// everything there but its own frames; error frames of the interface are not frames of the bus and
/// ignored.
class SocketCanLink final : public CanLink {
 public:
  static base::Expected<std::unique_ptr<CanLink>, LinkError> open(const std::string& interface);

  [[nodiscard]] int descriptor() const override { return waiting_.get(); }
  base::Expected<std::size_t, LinkError> receive(std::span<can::Frame> frames,
                                                 base::SimTime now) override;
  void send(const can::Frame& frame, base::SimTime time) override;
  /// Nothing: what is written to an interface is for its adapter to send, which has no way to.
  void send_error(const ErrorFrame& /*error*/, base::SimTime /*time*/) override {}
  void flush() override;
  [[nodiscard]] CanLinkStatistics statistics() const override;
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::string usage() const override;

 private:
  explicit SocketCanLink(const std::string& interface)
      : interface_(interface), name_("socketcan:" + interface) {}

  base::Expected<void, LinkError> start();
  base::Expected<void, LinkError> wait_for_socket();
  [[nodiscard]] LinkError interface_missing() const;
  void retry_soon();

  std::string interface_;
  std::string name_;
  FileDescriptor waiting_;
  FileDescriptor socket_;
  /// The queue of an interface that is full does not tell when it has room again.
  FileDescriptor retry_;
  bool retry_set_ = false;
  std::deque<can_frame> queue_;
  CanLinkStatistics statistics_;
};

}  // namespace stator::link
