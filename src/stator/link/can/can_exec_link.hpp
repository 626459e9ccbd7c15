#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <linux/can.h>

#include "stator/link/can/broadcast_manager.hpp"
#include "stator/link/can/can_exec_protocol.hpp"
#include "stator/link/can/can_link.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// The port behind "stator can-exec": programs written for SocketCAN, unmodified, on any kernel. It
/// does what the kernel does for CAN sockets: filters, loopback, reception of own messages, cyclic
/// transmission.
class CanExecLink final : public CanLink {
 public:
  /// `name` is that of the interface the programs see.
  static base::Expected<std::unique_ptr<CanLink>, LinkError> open(
      const std::string& name, const CanLinkOptions& options = {});
  ~CanExecLink() override;

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
  /// One socket of a program.
  struct Client {
    FileDescriptor descriptor;
    /// Nothing is sent before the first one.
    std::optional<can_exec::Configuration> configuration;
    std::vector<can_filter> filters;
    BroadcastManager broadcast_manager;
    /// Messages, each behind its length in two bytes.
    std::string output;
    std::size_t output_sent = 0;
    bool waits_to_write = false;
    bool ended = false;
  };
  struct Target {
    std::span<can::Frame> frames;
    std::size_t count = 0;
    [[nodiscard]] bool full() const { return count == frames.size(); }
  };

  CanExecLink(const std::string& interface, unsigned bit_rate)
      : interface_(interface), name_("can-exec:" + interface), bit_rate_(bit_rate) {}

  base::Expected<void, LinkError> listen();
  [[nodiscard]] bool is_served() const;
  bool watch(int descriptor);
  void accept();
  void read(Client& client, Target& target);
  void take(Client& client, std::span<const std::byte> message, Target& target);
  bool configure(Client& client, std::span<const std::byte> message);
  void deliver(const can::Frame& frame, Client& from, Target& target);
  void deliver_pending(Target& target);
  void advance(Target& target);
  void set_timer();
  void put(Client& client, const can_frame& frame, std::uint32_t flags);
  void queue(Client& client, std::string_view message, std::uint32_t flags);
  void answer_inquiry(Client& client);
  void write(Client& client);
  void wait_to_write(Client& client, bool wait);
  void end(Client& client);
  [[nodiscard]] Client* find(int descriptor);

  std::string interface_;
  std::string name_;
  unsigned bit_rate_;  ///< kbit/s; 0: not known or unlimited
  /// Of the socket; empty while it is not this object's.
  std::string path_;
  FileDescriptor waiting_;
  FileDescriptor listener_;
  FileDescriptor timer_;
  std::optional<MachineTime> timer_set_to_;
  std::vector<std::unique_ptr<Client>> clients_;
  static constexpr int kNobody = -1;
  /// The program for whose frames receive() had no room: it comes first next time, before one that
  /// sends without a pause.
  int waits_for_room_ = kNobody;
  /// Cyclic frames for which receive() had no room.
  std::vector<can::Frame> pending_;
  CanLinkStatistics statistics_;
  std::uint64_t bytes_received_ = 0;
  std::uint64_t bytes_sent_ = 0;
  std::uint64_t error_frames_ = 0;
};

/// A CAN filter of Linux lets `frame` pass: its identifier and flags, masked, are the filter's, or
/// with CAN_INV_FILTER are not.
[[nodiscard]] bool passes(const can_filter& filter, const can_frame& frame);

}  // namespace stator::link
