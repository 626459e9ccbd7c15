#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <sys/socket.h>

#include "stator/link/can_exec/descriptor_table.hpp"
#include "stator/link/can_exec/link_message.hpp"

namespace stator::link::can_exec {

/// A NETLINK_ROUTE socket of the program. The kernel hears every request and answers it; only where
/// an answer ends that the buses belong into, or says that there is no such interface, the messages
/// about the buses take their place. A program that waits for the socket is woken as ever, because
/// the kernel's answer stays there until those before it are read.
class RouteSocket {
 public:
  /// Notes the questions about interfaces among what the program is about to send.
  void note(std::span<const std::byte> datagram);

  /// The program has asked something whose answer is not read to its end yet.
  [[nodiscard]] bool awaits_answers();

  /// What recvmsg() does.
  ssize_t receive(int descriptor, msghdr& message, int flags);

 private:
  struct Pending {
    std::uint32_t sequence = 0;
    LinkQuestion question;
    bool acknowledge = false;
    /// Complete messages about buses, once the kernel's answer is there.
    std::optional<std::vector<std::string>> answers{};
    std::size_t given = 0;
  };
  using Place = std::vector<Pending>::iterator;

  /// The question that a datagram of the kernel ends the answer to.
  [[nodiscard]] Place find_ended(std::span<const std::byte> datagram, nlmsghdr& end);
  void prepare(Pending& pending, const nlmsghdr& end);
  ssize_t give_answers(Pending& pending, msghdr& message, int flags);
  ssize_t give_end(int descriptor, const Pending& pending, const nlmsghdr& end, msghdr& message,
                   int flags);
  ssize_t hand_over(std::span<const std::byte> datagram, msghdr& message, int flags) const;

  std::mutex mutex_;
  std::vector<Pending> pending_;
};

/// The NETLINK_ROUTE sockets of this process.
using RouteSockets = DescriptorTable<RouteSocket>;

}  // namespace stator::link::can_exec
