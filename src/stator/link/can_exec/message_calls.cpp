// What a program does to send and receive on a CAN socket, in all the ways the C library has.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <ctime>
#include <memory>
#include <vector>

#include <linux/can/bcm.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include "stator/link/can/can_exec_protocol.hpp"
#include "stator/link/can_exec/program_socket.hpp"
#include "stator/link/can_exec/route_socket.hpp"
#include "stator/link/can_exec/system_calls.hpp"

#define STATOR_EXPORT extern "C" __attribute__((visibility("default")))

namespace stator::link::can_exec {

int connect_to_bus(int descriptor, ProgramSocket& socket, const sockaddr* address,
                   socklen_t length);

namespace {

ssize_t refuse(int error) {
  errno = error;
  return -1;
}

/// The other end of the socket is gone: as if the interface was switched off.
ssize_t interface_failure(int error) {
  return refuse(error == EPIPE || error == ECONNRESET || error == ENOTCONN ? ENETDOWN : error);
}

/// What the port has added to a message in `whole`, and what it says.
void apply_origin(const ProgramSocket& socket, const std::byte* origin, msghdr& message) {
  Origin from;
  std::memcpy(&from, origin, sizeof from);
  message.msg_flags |= (from.flags & kFromProgram) != 0 ? MSG_DONTROUTE : 0;
  message.msg_flags |= (from.flags & kOwn) != 0 ? MSG_CONFIRM : 0;
  if (message.msg_name != nullptr) {
    sockaddr_can sender{};
    sender.can_family = AF_CAN;
    sender.can_ifindex = socket.bus_index;
    message.msg_namelen =
        static_cast<socklen_t>(std::min<std::size_t>(message.msg_namelen, sizeof sender));
    std::memcpy(message.msg_name, &sender, message.msg_namelen);
  }
}

/// Copies `size` bytes to where the program wants them; what does not fit is lost, as with any
/// datagram.
ssize_t scatter(const std::byte* from, std::size_t size, msghdr& message) {
  std::size_t copied = 0;
  for (std::size_t i = 0; i < message.msg_iovlen && copied < size; ++i) {
    const iovec& part = message.msg_iov[i];
    const std::size_t length = std::min(part.iov_len, size - copied);
    std::memcpy(part.iov_base, from + copied, length);
    copied += length;
  }
  message.msg_flags |= copied < size ? MSG_TRUNC : 0;
  return static_cast<ssize_t>(copied);
}

ssize_t receive_from_bus(int descriptor, ProgramSocket& socket, msghdr& message, int flags) {
  if (!socket.connected) {
    // Nothing can come; a program that waits would wait for ever.
    return refuse(EAGAIN);
  }
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): long, and the system fills it
  std::array<std::byte, kMaximumMessage> whole;
  iovec part{.iov_base = whole.data(), .iov_len = whole.size()};
  msghdr inner = message;
  inner.msg_name = nullptr;
  inner.msg_namelen = 0;
  inner.msg_iov = &part;
  inner.msg_iovlen = 1;
  const ssize_t size = STATOR_SYSTEM(recvmsg)(descriptor, &inner, flags);
  if (size < 0) {
    return interface_failure(errno);
  }
  if (size < static_cast<ssize_t>(sizeof(Origin))) {
    return refuse(ENETDOWN);
  }
  ::clock_gettime(CLOCK_REALTIME, &socket.received);
  message.msg_controllen = inner.msg_controllen;
  message.msg_flags = inner.msg_flags & ~MSG_EOR;
  const std::size_t content = static_cast<std::size_t>(size) - sizeof(Origin);
  apply_origin(socket, whole.data() + content, message);
  return scatter(whole.data(), content, message);
}

/// 0, or why Linux would refuse a frame on an interface of classical CAN.
int check_frame(const std::byte* bytes, std::size_t size) {
  can_frame frame{};
  if (size != sizeof frame) {
    return EINVAL;
  }
  std::memcpy(&frame, bytes, sizeof frame);
  return frame.can_dlc > CAN_MAX_DLEN ? EINVAL : 0;
}

/// 0, or why the broadcast manager would refuse a command. What it does is the port's; which
/// entries there are must be known here, because the program is told at once.
int check_broadcast_command(ProgramSocket& socket, const std::byte* bytes, std::size_t size) {
  struct {
    std::uint32_t opcode, flags, count;
    bcm_timeval ival1, ival2;
    canid_t can_id;
    std::uint32_t nframes;
  } head{};
  static_assert(sizeof head == sizeof(bcm_msg_head));
  if (size < sizeof head) {
    return EINVAL;
  }
  std::memcpy(&head, bytes, sizeof head);
  const std::size_t frames = (size - sizeof head) / sizeof(can_frame);
  switch (head.opcode) {
    case TX_SETUP:
      if (head.nframes == 0 || frames != head.nframes || (head.flags & CAN_FD_FRAME) != 0) {
        return EINVAL;
      }
      socket.transmissions.insert(head.can_id);
      return 0;
    case TX_DELETE:
      return socket.transmissions.erase(head.can_id) != 0 ? 0 : EINVAL;
    case TX_READ:
      return socket.transmissions.contains(head.can_id) ? 0 : EINVAL;
    case TX_SEND:
      return head.nframes == 1 && frames == 1 ? 0 : EINVAL;
    case RX_SETUP:
      // Filters by multiplex bytes are not served.
      if (frames > 1 || (head.flags & CAN_FD_FRAME) != 0) {
        return EOPNOTSUPP;
      }
      socket.receptions.insert(head.can_id);
      return 0;
    case RX_DELETE:
      return socket.receptions.erase(head.can_id) != 0 ? 0 : EINVAL;
    case RX_READ:
      return socket.receptions.contains(head.can_id) ? 0 : EINVAL;
    default:
      return EINVAL;
  }
}

/// An address is needed where bind() has named no bus, and may name no other one.
int check_destination(int descriptor, ProgramSocket& socket, const msghdr& message) {
  if (message.msg_name == nullptr) {
    return socket.connected ? 0 : ENXIO;
  }
  if (!socket.connected) {
    // A socket that was never bound sends, but receives nothing.
    socket.filters.clear();
    return connect_to_bus(descriptor, socket, static_cast<const sockaddr*>(message.msg_name),
                          message.msg_namelen) == 0
               ? 0
               : errno;
  }
  sockaddr_can to{};
  std::memcpy(&to, message.msg_name, std::min<std::size_t>(message.msg_namelen, sizeof to));
  return to.can_ifindex == 0 || to.can_ifindex == socket.bus_index ? 0 : ENXIO;
}

ssize_t transmit(int descriptor, ProgramSocket& socket, const msghdr& message, int flags) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init): long, and filled below
  std::array<std::byte, kMaximumMessage> whole;
  std::size_t size = 0;
  for (std::size_t i = 0; i < message.msg_iovlen; ++i) {
    const iovec& part = message.msg_iov[i];
    if (part.iov_len > whole.size() - size) {
      return refuse(EINVAL);
    }
    std::memcpy(whole.data() + size, part.iov_base, part.iov_len);
    size += part.iov_len;
  }
  int error = check_destination(descriptor, socket, message);
  if (error == 0) {
    error = socket.kind == SocketKind::raw ? check_frame(whole.data(), size)
                                           : check_broadcast_command(socket, whole.data(), size);
  }
  if (error != 0) {
    return refuse(error);
  }
  const ssize_t sent =
      STATOR_SYSTEM(send)(descriptor, whole.data(), size, (flags & MSG_DONTWAIT) | MSG_NOSIGNAL);
  return sent < 0 ? interface_failure(errno) : sent;
}

/// A socket the library takes care of.
struct Ours {
  std::shared_ptr<ProgramSocket> bus;
  std::shared_ptr<RouteSocket> route;
  explicit operator bool() const { return bus || route; }
};

/// Nothing where the C library does what is asked: it receives for netlink sockets unless the
/// program waits for an answer that the buses belong into.
Ours find(int descriptor) {
  Ours found{.bus = ProgramSockets::instance().find(descriptor), .route = nullptr};
  if (!found) {
    found.route = RouteSockets::instance().find(descriptor);
    if (found.route && !found.route->awaits_answers()) {
      found.route = nullptr;
    }
  }
  return found;
}

std::shared_ptr<ProgramSocket> find_bus(int descriptor) {
  return ProgramSockets::instance().find(descriptor);
}

/// Lets a netlink socket know what the program is about to send by it.
void note(int descriptor, const iovec* parts, std::size_t count) {
  const auto route = RouteSockets::instance().find(descriptor);
  if (!route) {
    return;
  }
  std::vector<std::byte> whole;
  for (std::size_t i = 0; i < count; ++i) {
    const auto* const from = static_cast<const std::byte*>(parts[i].iov_base);
    whole.insert(whole.end(), from, from + parts[i].iov_len);
  }
  route->note(whole);
}

void note(int descriptor, const void* buffer, std::size_t size) {
  const iovec part{.iov_base = const_cast<void*>(buffer), .iov_len = size};
  note(descriptor, &part, 1);
}

ssize_t receive(int descriptor, const Ours& socket, msghdr& message, int flags) {
  return socket.bus ? receive_from_bus(descriptor, *socket.bus, message, flags)
                    : socket.route->receive(descriptor, message, flags);
}

ssize_t receive_into(int descriptor, const Ours& socket, void* buffer, std::size_t size,
                     int flags) {
  iovec part{.iov_base = buffer, .iov_len = size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  return receive(descriptor, socket, message, flags);
}

ssize_t receive_from(int descriptor, const Ours& socket, void* buffer, std::size_t size, int flags,
                     sockaddr* address, socklen_t* length) {
  iovec part{.iov_base = buffer, .iov_len = size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_name = length == nullptr ? nullptr : address;
  message.msg_namelen = length == nullptr ? 0 : *length;
  const ssize_t received = receive(descriptor, socket, message, flags);
  if (received >= 0 && length != nullptr) {
    *length = message.msg_namelen;
  }
  return received;
}

ssize_t transmit_from(int descriptor, ProgramSocket& socket, const void* buffer, std::size_t size,
                      int flags, const sockaddr* address = nullptr, socklen_t length = 0) {
  iovec part{.iov_base = const_cast<void*>(buffer), .iov_len = size};
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_name = const_cast<sockaddr*>(address);
  message.msg_namelen = length;
  return transmit(descriptor, socket, message, flags);
}

ssize_t receive_parts(int descriptor, const Ours& socket, const iovec* parts, int count) {
  msghdr message{};
  message.msg_iov = const_cast<iovec*>(parts);
  message.msg_iovlen = static_cast<std::size_t>(std::max(count, 0));
  return receive(descriptor, socket, message, 0);
}

ssize_t transmit_parts(int descriptor, ProgramSocket& socket, const iovec* parts, int count) {
  msghdr message{};
  message.msg_iov = const_cast<iovec*>(parts);
  message.msg_iovlen = static_cast<std::size_t>(std::max(count, 0));
  return transmit(descriptor, socket, message, 0);
}

}  // namespace

}  // namespace stator::link::can_exec

using namespace stator::link::can_exec;

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the C library's are no words

STATOR_EXPORT ssize_t read(int descriptor, void* buffer, std::size_t size) {
  const auto found = find(descriptor);
  return found ? receive_into(descriptor, found, buffer, size, 0)
               : STATOR_SYSTEM(read)(descriptor, buffer, size);
}

STATOR_EXPORT ssize_t readv(int descriptor, const iovec* parts, int count) {
  const auto found = find(descriptor);
  return found ? receive_parts(descriptor, found, parts, count)
               : STATOR_SYSTEM(readv)(descriptor, parts, count);
}

STATOR_EXPORT ssize_t recv(int descriptor, void* buffer, std::size_t size, int flags) {
  const auto found = find(descriptor);
  return found ? receive_into(descriptor, found, buffer, size, flags)
               : STATOR_SYSTEM(recv)(descriptor, buffer, size, flags);
}

STATOR_EXPORT ssize_t recvfrom(int descriptor, void* buffer, std::size_t size, int flags,
                               sockaddr* address, socklen_t* length) {
  const auto found = find(descriptor);
  return found ? receive_from(descriptor, found, buffer, size, flags, address, length)
               : STATOR_SYSTEM(recvfrom)(descriptor, buffer, size, flags, address, length);
}

STATOR_EXPORT ssize_t recvmsg(int descriptor, msghdr* message, int flags) {
  const auto found = find(descriptor);
  return found ? receive(descriptor, found, *message, flags)
               : STATOR_SYSTEM(recvmsg)(descriptor, message, flags);
}

STATOR_EXPORT int recvmmsg(int descriptor, mmsghdr* messages, unsigned count, int flags,
                           timespec* timeout) {
  const auto found = find(descriptor);
  if (!found) {
    return STATOR_SYSTEM(recvmmsg)(descriptor, messages, count, flags, timeout);
  }
  int received = 0;
  for (unsigned i = 0; i < count; ++i) {
    const int more = received > 0 && (flags & MSG_WAITFORONE) != 0 ? MSG_DONTWAIT : 0;
    const ssize_t size =
        receive(descriptor, found, messages[i].msg_hdr, (flags & ~MSG_WAITFORONE) | more);
    if (size < 0) {
      return received > 0 ? received : -1;
    }
    messages[i].msg_len = static_cast<unsigned>(size);
    ++received;
  }
  return received;
}

STATOR_EXPORT ssize_t write(int descriptor, const void* buffer, std::size_t size) {
  const auto found = find_bus(descriptor);
  if (!found) {
    note(descriptor, buffer, size);
  }
  return found ? transmit_from(descriptor, *found, buffer, size, 0)
               : STATOR_SYSTEM(write)(descriptor, buffer, size);
}

STATOR_EXPORT ssize_t writev(int descriptor, const iovec* parts, int count) {
  const auto found = find_bus(descriptor);
  if (!found) {
    note(descriptor, parts, static_cast<std::size_t>(std::max(count, 0)));
  }
  return found ? transmit_parts(descriptor, *found, parts, count)
               : STATOR_SYSTEM(writev)(descriptor, parts, count);
}

STATOR_EXPORT ssize_t send(int descriptor, const void* buffer, std::size_t size, int flags) {
  const auto found = find_bus(descriptor);
  if (!found) {
    note(descriptor, buffer, size);
  }
  return found ? transmit_from(descriptor, *found, buffer, size, flags)
               : STATOR_SYSTEM(send)(descriptor, buffer, size, flags);
}

STATOR_EXPORT ssize_t sendto(int descriptor, const void* buffer, std::size_t size, int flags,
                             const sockaddr* address, socklen_t length) {
  const auto found = find_bus(descriptor);
  if (!found) {
    note(descriptor, buffer, size);
  }
  return found ? transmit_from(descriptor, *found, buffer, size, flags, address, length)
               : STATOR_SYSTEM(sendto)(descriptor, buffer, size, flags, address, length);
}

STATOR_EXPORT ssize_t sendmsg(int descriptor, const msghdr* message, int flags) {
  const auto found = find_bus(descriptor);
  if (!found) {
    note(descriptor, message->msg_iov, message->msg_iovlen);
  }
  return found ? transmit(descriptor, *found, *message, flags)
               : STATOR_SYSTEM(sendmsg)(descriptor, message, flags);
}

STATOR_EXPORT int sendmmsg(int descriptor, mmsghdr* messages, unsigned count, int flags) {
  const auto found = find_bus(descriptor);
  if (!found) {
    return STATOR_SYSTEM(sendmmsg)(descriptor, messages, count, flags);
  }
  int sent = 0;
  for (unsigned i = 0; i < count; ++i) {
    const ssize_t size = transmit(descriptor, *found, messages[i].msg_hdr, flags);
    if (size < 0) {
      return sent > 0 ? sent : -1;
    }
    messages[i].msg_len = static_cast<unsigned>(size);
    ++sent;
  }
  return sent;
}

// NOLINTEND(readability-inconsistent-declaration-parameter-name)

// What programs call instead that were built with _FORTIFY_SOURCE.
// NOLINTBEGIN(*-reserved-identifier,cert-dcl*,*-identifier-naming): so they are called

STATOR_EXPORT ssize_t __read_chk(int descriptor, void* buffer, std::size_t size,
                                 std::size_t /*room*/) {
  return read(descriptor, buffer, size);
}

STATOR_EXPORT ssize_t __recv_chk(int descriptor, void* buffer, std::size_t size,
                                 std::size_t /*room*/, int flags) {
  return recv(descriptor, buffer, size, flags);
}

STATOR_EXPORT ssize_t __recvfrom_chk(int descriptor, void* buffer, std::size_t size,
                                     std::size_t /*room*/, int flags, sockaddr* address,
                                     socklen_t* length) {
  return recvfrom(descriptor, buffer, size, flags, address, length);
}

// NOLINTEND(*-reserved-identifier,cert-dcl*,*-identifier-naming)
