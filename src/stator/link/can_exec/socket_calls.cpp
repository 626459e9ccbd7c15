// What a program does to make and set up a CAN socket: socket, bind, connect, options, names,
// copies.

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstring>

#include <fcntl.h>
#include <linux/can/raw.h>
#include <linux/close_range.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "stator/link/can/can_exec_protocol.hpp"
#include "stator/link/can_exec/program_socket.hpp"
#include "stator/link/can_exec/route_socket.hpp"
#include "stator/link/can_exec/system_calls.hpp"

#define STATOR_EXPORT extern "C" __attribute__((visibility("default")))

namespace stator::link::can_exec {

namespace {

constexpr int kPortAnswers = 10'000;  // ms
/// As much as the system allows below: programs that find the buffer full give up.
constexpr int kSendBuffer = 4 << 20;

int refuse(int error) {
  errno = error;
  return -1;
}

std::string configuration_message(const ProgramSocket& socket) {
  Configuration configuration;
  configuration.kind = socket.kind;
  configuration.options = socket.options;
  configuration.error_mask = socket.error_mask;
  configuration.filter_count = static_cast<std::uint32_t>(socket.filters.size());
  std::string message(reinterpret_cast<const char*>(&configuration), sizeof configuration);
  message.append(reinterpret_cast<const char*>(socket.filters.data()),
                 socket.filters.size() * sizeof(can_filter));
  return message;
}

/// Tells the port of the options; waits if it is busy, whatever the descriptor's mode.
int send_configuration(int descriptor, const ProgramSocket& socket) {
  if (!socket.connected) {
    return 0;
  }
  const std::string message = configuration_message(socket);
  const int flags = STATOR_SYSTEM(fcntl)(descriptor, F_GETFL);
  STATOR_SYSTEM(fcntl)(descriptor, F_SETFL, flags & ~O_NONBLOCK);
  const ssize_t sent =
      STATOR_SYSTEM(send)(descriptor, message.data(), message.size(), MSG_NOSIGNAL);
  const int error = errno;
  STATOR_SYSTEM(fcntl)(descriptor, F_SETFL, flags);
  return sent < 0 ? refuse(error == EPIPE ? ENETDOWN : error) : 0;
}

/// Waits until the port says that the socket hears the bus. Programs rely on hearing what is sent
/// after bind().
int wait_for_port(int descriptor) {
  pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
  Origin origin;
  if (STATOR_SYSTEM(poll)(&waiting, 1, kPortAnswers) != 1 ||
      STATOR_SYSTEM(recv)(descriptor, &origin, sizeof origin, 0) != sizeof origin ||
      (origin.flags & kConnected) == 0) {
    return refuse(ENETDOWN);
  }
  return 0;
}

/// Copies an option's value out as getsockopt() does.
int give(const void* value, std::size_t size, void* to, socklen_t* length) {
  if (to == nullptr || length == nullptr) {
    return refuse(EFAULT);
  }
  *length = static_cast<socklen_t>(std::min<std::size_t>(*length, size));
  std::memcpy(to, value, *length);
  return 0;
}

int set_filters(ProgramSocket& socket, const void* value, socklen_t length) {
  if (length % sizeof(can_filter) != 0 || length > kMaximumFilters * sizeof(can_filter)) {
    return refuse(EINVAL);
  }
  socket.filters.resize(length / sizeof(can_filter));
  if (length != 0) {
    std::memcpy(socket.filters.data(), value, length);
  }
  return 0;
}

int set_option(ProgramSocket& socket, int option, const void* value, socklen_t length) {
  if (option == CAN_RAW_FILTER) {
    return set_filters(socket, value, length);
  }
  int number = 0;
  if (length != sizeof number || value == nullptr) {
    return refuse(EINVAL);
  }
  std::memcpy(&number, value, sizeof number);
  const auto set_bit = [&](std::uint8_t bit) {
    socket.options =
        static_cast<std::uint8_t>(number != 0 ? socket.options | bit : socket.options & ~bit);
  };
  switch (option) {
    case CAN_RAW_ERR_FILTER:
      socket.error_mask = static_cast<std::uint32_t>(number) & CAN_ERR_MASK;
      return 0;
    case CAN_RAW_LOOPBACK:
      set_bit(kLoopback);
      return 0;
    case CAN_RAW_RECV_OWN_MSGS:
      set_bit(kReceiveOwn);
      return 0;
    case CAN_RAW_JOIN_FILTERS:
      set_bit(kJoinFilters);
      return 0;
    case CAN_RAW_FD_FRAMES:  // as with an interface of classical CAN: taken, never of use
      socket.flexible_data_rate = number != 0;
      return 0;
    default:
      return refuse(ENOPROTOOPT);
  }
}

int get_option(const ProgramSocket& socket, int option, void* value, socklen_t* length) {
  const auto give_number = [&](int number) { return give(&number, sizeof number, value, length); };
  switch (option) {
    case CAN_RAW_FILTER:
      return give(socket.filters.data(), socket.filters.size() * sizeof(can_filter), value, length);
    case CAN_RAW_ERR_FILTER:
      return give_number(static_cast<int>(socket.error_mask));
    case CAN_RAW_LOOPBACK:
      return give_number((socket.options & kLoopback) != 0 ? 1 : 0);
    case CAN_RAW_RECV_OWN_MSGS:
      return give_number((socket.options & kReceiveOwn) != 0 ? 1 : 0);
    case CAN_RAW_JOIN_FILTERS:
      return give_number((socket.options & kJoinFilters) != 0 ? 1 : 0);
    case CAN_RAW_FD_FRAMES:
      return give_number(socket.flexible_data_rate ? 1 : 0);
    default:
      return refuse(ENOPROTOOPT);
  }
}

void share(int from, int to) {
  if (to >= 0) {
    ProgramSockets::instance().share(from, to);
    RouteSockets::instance().share(from, to);
  }
}

}  // namespace

int connect_to_bus(int descriptor, ProgramSocket& socket, const sockaddr* address,
                   socklen_t length) {
  if (address == nullptr || length < offsetof(sockaddr_can, can_addr) ||
      address->sa_family != AF_CAN) {
    return refuse(EINVAL);
  }
  sockaddr_can wanted{};
  std::memcpy(&wanted, address, std::min<std::size_t>(length, sizeof wanted));
  // Index 0 is "any"; a socket has one peer, so that is the first bus.
  const Bus* const bus = wanted.can_ifindex != 0 ? bus_with_index(wanted.can_ifindex)
                         : buses().empty()       ? nullptr
                                                 : &buses().front();
  if (bus == nullptr) {
    return refuse(ENODEV);
  }
  if (socket.connected) {
    return socket.bus_index == bus->index ? 0 : refuse(EINVAL);
  }
  sockaddr_un port{};
  port.sun_family = AF_UNIX;
  std::strncpy(port.sun_path, bus->path.c_str(), sizeof port.sun_path - 1);
  if (STATOR_SYSTEM(connect)(descriptor, reinterpret_cast<const sockaddr*>(&port), sizeof port) !=
      0) {
    return refuse(ENETDOWN);
  }
  socket.connected = true;
  socket.bound_index = wanted.can_ifindex;
  socket.bus_index = bus->index;
  const int sent = send_configuration(descriptor, socket);
  return sent != 0 ? sent : wait_for_port(descriptor);
}

}  // namespace stator::link::can_exec

using namespace stator::link::can_exec;

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the C library's are no words

STATOR_EXPORT int socket(int domain, int type, int protocol) noexcept {
  if (domain != PF_CAN) {
    const int descriptor = STATOR_SYSTEM(socket)(domain, type, protocol);
    if (descriptor >= 0 && domain == PF_NETLINK && protocol == NETLINK_ROUTE && !buses().empty()) {
      RouteSockets::instance().add(descriptor, std::make_shared<RouteSocket>());
    }
    return descriptor;
  }
  constexpr int kModes = SOCK_CLOEXEC | SOCK_NONBLOCK;
  const int kind = type & ~kModes;
  const bool raw = kind == SOCK_RAW && protocol == CAN_RAW;
  if (!raw && !(kind == SOCK_DGRAM && protocol == CAN_BCM)) {
    return refuse(EPROTONOSUPPORT);
  }
  const int descriptor = STATOR_SYSTEM(socket)(AF_UNIX, SOCK_SEQPACKET | (type & kModes), 0);
  if (descriptor >= 0) {
    if (STATOR_SYSTEM(setsockopt)(descriptor, SOL_SOCKET, SO_SNDBUFFORCE, &kSendBuffer,
                                  sizeof kSendBuffer) != 0) {
      STATOR_SYSTEM(setsockopt)
      (descriptor, SOL_SOCKET, SO_SNDBUF, &kSendBuffer, sizeof kSendBuffer);
    }
    auto made = std::make_shared<ProgramSocket>();
    made->kind = raw ? SocketKind::raw : SocketKind::broadcast_manager;
    ProgramSockets::instance().add(descriptor, std::move(made));
  }
  return descriptor;
}

STATOR_EXPORT int bind(int descriptor, const sockaddr* address, socklen_t length) noexcept {
  const auto found = ProgramSockets::instance().find(descriptor);
  if (!found) {
    return STATOR_SYSTEM(bind)(descriptor, address, length);
  }
  return found->kind == SocketKind::raw ? connect_to_bus(descriptor, *found, address, length)
                                        : refuse(EOPNOTSUPP);
}

STATOR_EXPORT int connect(int descriptor, const sockaddr* address, socklen_t length) {
  const auto found = ProgramSockets::instance().find(descriptor);
  if (!found) {
    return STATOR_SYSTEM(connect)(descriptor, address, length);
  }
  return found->kind == SocketKind::broadcast_manager
             ? connect_to_bus(descriptor, *found, address, length)
             : refuse(EOPNOTSUPP);
}

STATOR_EXPORT int setsockopt(int descriptor, int level, int option, const void* value,
                             socklen_t length) noexcept {
  const auto found = ProgramSockets::instance().find(descriptor);
  if (!found || level != SOL_CAN_RAW) {
    return STATOR_SYSTEM(setsockopt)(descriptor, level, option, value, length);
  }
  const int result = set_option(*found, option, value, length);
  return result != 0 ? result : send_configuration(descriptor, *found);
}

STATOR_EXPORT int getsockopt(int descriptor, int level, int option, void* value,
                             socklen_t* length) noexcept {
  const auto found = ProgramSockets::instance().find(descriptor);
  if (found && level == SOL_CAN_RAW) {
    return get_option(*found, option, value, length);
  }
  if (found && level == SOL_SOCKET &&
      (option == SO_DOMAIN || option == SO_TYPE || option == SO_PROTOCOL)) {
    const bool raw = found->kind == SocketKind::raw;
    const int number = option == SO_DOMAIN ? PF_CAN
                       : option == SO_TYPE ? (raw ? SOCK_RAW : SOCK_DGRAM)
                                           : (raw ? CAN_RAW : CAN_BCM);
    return give(&number, sizeof number, value, length);
  }
  return STATOR_SYSTEM(getsockopt)(descriptor, level, option, value, length);
}

STATOR_EXPORT int getsockname(int descriptor, sockaddr* address, socklen_t* length) noexcept {
  const auto found = ProgramSockets::instance().find(descriptor);
  if (!found) {
    return STATOR_SYSTEM(getsockname)(descriptor, address, length);
  }
  sockaddr_can own{};
  own.can_family = AF_CAN;
  own.can_ifindex = found->bound_index;
  return give(&own, sizeof own, address, length);
}

STATOR_EXPORT int close(int descriptor) {
  ProgramSockets::instance().remove(descriptor);
  RouteSockets::instance().remove(descriptor);
  return STATOR_SYSTEM(close)(descriptor);
}

STATOR_EXPORT int close_range(unsigned first, unsigned last, int flags) noexcept {
  if ((static_cast<unsigned>(flags) & CLOSE_RANGE_CLOEXEC) == 0) {
    ProgramSockets::instance().remove(first, last);
    RouteSockets::instance().remove(first, last);
  }
  return STATOR_SYSTEM(close_range)(first, last, flags);
}

STATOR_EXPORT void closefrom(int first) noexcept {
  const auto begin = static_cast<unsigned>(std::max(first, 0));
  ProgramSockets::instance().remove(begin, ~0U);
  RouteSockets::instance().remove(begin, ~0U);
  STATOR_SYSTEM(closefrom)(first);
}

STATOR_EXPORT int dup(int descriptor) noexcept {
  const int copy = STATOR_SYSTEM(dup)(descriptor);
  share(descriptor, copy);
  return copy;
}

STATOR_EXPORT int dup2(int descriptor, int to) noexcept {
  const int copy = STATOR_SYSTEM(dup2)(descriptor, to);
  if (descriptor != to) {
    share(descriptor, copy);
  }
  return copy;
}

STATOR_EXPORT int dup3(int descriptor, int to, int flags) noexcept {
  const int copy = STATOR_SYSTEM(dup3)(descriptor, to, flags);
  share(descriptor, copy);
  return copy;
}

STATOR_EXPORT int fcntl(int descriptor, int command, ...) {
  std::va_list arguments;
  va_start(arguments, command);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  const int result = STATOR_SYSTEM(fcntl)(descriptor, command, argument);
  if (command == F_DUPFD || command == F_DUPFD_CLOEXEC) {
    share(descriptor, result);
  }
  return result;
}

STATOR_EXPORT int fcntl64(int descriptor, int command, ...) {
  std::va_list arguments;
  va_start(arguments, command);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  return fcntl(descriptor, command, argument);
}

// NOLINTEND(readability-inconsistent-declaration-parameter-name)
