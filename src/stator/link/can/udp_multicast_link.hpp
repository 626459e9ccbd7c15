#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include <netinet/in.h>

#include "stator/link/can/can_link.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/can/multicast_message.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// Frames as datagrams to a multicast group, as python-can's interface "udp_multicast" has them.
/// All programs of all machines in the group hear everything; datagrams can be lost.
///
/// Sends from a socket of its own, whose datagrams a filter in the kernel keeps from the receiving
/// one: there they would take the room of what programs send.
class UdpMulticastLink final : public CanLink {
 public:
  /// `epoch` as in CanLinkOptions.
  static base::Expected<std::unique_ptr<CanLink>, LinkError> open(const CanLinkAddress& address,
                                                                  base::SimDuration epoch);

  [[nodiscard]] int descriptor() const override { return waiting_.get(); }
  base::Expected<std::size_t, LinkError> receive(std::span<can::Frame> frames,
                                                 base::SimTime now) override;
  void send(const can::Frame& frame, base::SimTime time) override;
  void send_error(const ErrorFrame& error, base::SimTime time) override;
  void flush() override;
  [[nodiscard]] CanLinkStatistics statistics() const override;
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] std::string usage() const override;

 private:
  UdpMulticastLink(const CanLinkAddress& address, base::SimDuration epoch)
      : address_(address), name_(to_text(address)), epoch_(epoch) {}

  base::Expected<void, LinkError> open_receiver(const sockaddr_in& group);
  base::Expected<void, LinkError> open_sender(const sockaddr_in& group);
  base::Expected<void, LinkError> ignore_own_frames();
  base::Expected<void, LinkError> wait_for_both();
  [[nodiscard]] LinkError no_route(int error) const;
  void queue(const MulticastMessage& message);
  void wait_to_write(bool wait);

  CanLinkAddress address_;
  std::string name_;
  base::SimDuration epoch_;
  FileDescriptor waiting_;
  FileDescriptor receiver_;
  FileDescriptor sender_;
  bool waits_to_write_ = false;
  std::deque<MulticastMessage> queue_;
  CanLinkStatistics statistics_;
};

}  // namespace stator::link
