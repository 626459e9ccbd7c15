#include "stator/link/can_exec/bus_interface.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

#include <linux/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "stator/link/can_exec/system_calls.hpp"

namespace stator::link::can_exec {

namespace {

constexpr int kPortAnswers = 1'000;  // ms

/// False: the port does not answer.
bool inquire(int descriptor, PortState& state) {
  const Configuration inquiry{.kind = SocketKind::inquiry};
  std::array<std::byte, sizeof(PortState) + sizeof(Origin)> answer{};
  pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
  if (STATOR_SYSTEM(send)(descriptor, &inquiry, sizeof inquiry, MSG_NOSIGNAL) < 0 ||
      STATOR_SYSTEM(poll)(&waiting, 1, kPortAnswers) != 1 ||
      STATOR_SYSTEM(recv)(descriptor, answer.data(), answer.size(), 0) !=
          static_cast<ssize_t>(answer.size())) {
    return false;
  }
  std::memcpy(&state, answer.data(), sizeof state);
  return true;
}

}  // namespace

InterfaceState ask(const Bus& bus) {
  const int error = errno;
  InterfaceState state;
  sockaddr_un port{};
  port.sun_family = AF_UNIX;
  std::strncpy(port.sun_path, bus.path.c_str(), sizeof port.sun_path - 1);
  const int descriptor =
      STATOR_SYSTEM(socket)(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor >= 0) {
    const int connected =
        STATOR_SYSTEM(connect)(descriptor, reinterpret_cast<const sockaddr*>(&port), sizeof port);
    // One whose queue of connections is full runs, too.
    state.up = connected == 0 || errno == EAGAIN;
    if (connected == 0) {
      inquire(descriptor, state.port);
    }
    STATOR_SYSTEM(close)(descriptor);
  }
  errno = error;
  return state;
}

unsigned interface_flags(const InterfaceState& state) {
  constexpr unsigned kAlways = IFF_NOARP | IFF_ECHO;
  return state.up ? kAlways | IFF_UP | IFF_RUNNING | IFF_LOWER_UP : kAlways;
}

}  // namespace stator::link::can_exec
