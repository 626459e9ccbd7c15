#include "stator/link/can/udp_multicast_link.hpp"

#include <array>
#include <cerrno>
#include <utility>

#include <arpa/inet.h>
#include <linux/filter.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/socket_options.hpp"

namespace stator::link {

namespace {

/// As many bytes as the other transports keep for a program.
constexpr std::size_t kMaximumQueued = (std::size_t{16} << 20) / sizeof(MulticastMessage);
constexpr std::size_t kLargestDatagram = 2048;

}  // namespace

base::Expected<std::unique_ptr<CanLink>, LinkError> UdpMulticastLink::open(
    const CanLinkAddress& address, base::SimDuration epoch) {
  auto link = std::unique_ptr<UdpMulticastLink>(new UdpMulticastLink(address, epoch));
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(address.port);
  ::inet_pton(AF_INET, address.name.c_str(), &group.sin_addr);
  for (const auto step : {&UdpMulticastLink::open_receiver, &UdpMulticastLink::open_sender}) {
    if (const auto done = (link.get()->*step)(group); !done) {
      return base::Unexpected{done.error()};
    }
  }
  for (const auto step : {&UdpMulticastLink::ignore_own_frames, &UdpMulticastLink::wait_for_both}) {
    if (const auto done = (link.get()->*step)(); !done) {
      return base::Unexpected{done.error()};
    }
  }
  return std::unique_ptr<CanLink>(std::move(link));
}

LinkError UdpMulticastLink::no_route(int error) const {
  if (error == ENODEV || error == ENETUNREACH) {
    return {LinkErrorCode::interface_missing,
            "this machine has no route to the multicast group " + address_.name +
                "; connect it to a network, or let the group stay on this machine: "
                "sudo ip route add 224.0.0.0/4 dev lo"};
  }
  return system_failure("cannot use the multicast group of " + in_quotes(name_), error).error;
}

base::Expected<void, LinkError> UdpMulticastLink::open_receiver(const sockaddr_in& group) {
  receiver_ = FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!receiver_.is_open()) {
    return system_failure("cannot open a UDP socket for " + in_quotes(name_), errno);
  }
  enlarge_receive_buffer(receiver_.get());
  // Several programs of this machine listen to the same group and port.
  set_socket_option(receiver_.get(), SOL_SOCKET, SO_REUSEADDR, int{1});
  set_socket_option(receiver_.get(), SOL_SOCKET, SO_REUSEPORT, int{1});
  if (::bind(receiver_.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0) {
    if (errno == EADDRINUSE) {
      return fail(LinkErrorCode::address_in_use,
                  "another program has UDP port " + std::to_string(address_.port) + " of " +
                      address_.name +
                      " for itself alone (ss -lunp shows it); end it, or choose "
                      "another port: udp-multicast:" +
                      address_.name + ":PORT");
    }
    return system_failure("cannot listen at " + in_quotes(name_), errno);
  }
  const ip_mreq membership{.imr_multiaddr = group.sin_addr, .imr_interface = {}};
  if (!set_socket_option(receiver_.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, membership)) {
    return base::Unexpected{no_route(errno)};
  }
  return {};
}

base::Expected<void, LinkError> UdpMulticastLink::open_sender(const sockaddr_in& group) {
  sender_ = FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!sender_.is_open() ||
      !set_socket_option(sender_.get(), IPPROTO_IP, IP_MULTICAST_TTL, int{1}) ||
      !set_socket_option(sender_.get(), IPPROTO_IP, IP_MULTICAST_LOOP, int{1})) {
    return system_failure("cannot open a UDP socket for " + in_quotes(name_), errno);
  }
  if (::connect(sender_.get(), reinterpret_cast<const sockaddr*>(&group), sizeof group) != 0) {
    return base::Unexpected{no_route(errno)};
  }
  return {};
}

base::Expected<void, LinkError> UdpMulticastLink::ignore_own_frames() {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  ::getsockname(sender_.get(), reinterpret_cast<sockaddr*>(&own), &size);
  // Loads count from the UDP header, which begins with the source port.
  constexpr auto kIpSource = static_cast<std::uint32_t>(SKF_NET_OFF) + 12;
  std::array<sock_filter, 6> program{{
      {BPF_LD | BPF_H | BPF_ABS, 0, 0, 0},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 3, ntohs(own.sin_port)},
      {BPF_LD | BPF_W | BPF_ABS, 0, 0, kIpSource},
      {BPF_JMP | BPF_JEQ | BPF_K, 0, 1, ntohl(own.sin_addr.s_addr)},
      {BPF_RET | BPF_K, 0, 0, 0},
      {BPF_RET | BPF_K, 0, 0, 0xFFFF'FFFF},
  }};
  const sock_fprog filter{.len = program.size(), .filter = program.data()};
  if (!set_socket_option(receiver_.get(), SOL_SOCKET, SO_ATTACH_FILTER, filter)) {
    return system_failure("cannot tell own frames from others at " + in_quotes(name_), errno);
  }
  return {};
}

base::Expected<void, LinkError> UdpMulticastLink::wait_for_both() {
  waiting_ = FileDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  epoll_event incoming{};
  incoming.events = EPOLLIN;
  incoming.data.fd = receiver_.get();
  epoll_event nothing{};
  nothing.data.fd = sender_.get();
  if (!waiting_.is_open() ||
      ::epoll_ctl(waiting_.get(), EPOLL_CTL_ADD, receiver_.get(), &incoming) != 0 ||
      ::epoll_ctl(waiting_.get(), EPOLL_CTL_ADD, sender_.get(), &nothing) != 0) {
    return system_failure("cannot wait for " + in_quotes(name_), errno);
  }
  return {};
}

base::Expected<std::size_t, LinkError> UdpMulticastLink::receive(std::span<can::Frame> frames,
                                                                 base::SimTime /*now*/) {
  flush();
  std::size_t count = 0;
  while (count < frames.size()) {
    std::array<std::byte, kLargestDatagram> datagram{};
    const ssize_t size = ::recv(receiver_.get(), datagram.data(), datagram.size(), 0);
    if (size < 0) {
      if (errno == EAGAIN || errno == EINTR) {
        break;
      }
      return system_failure("cannot receive from " + in_quotes(name_), errno);
    }
    const auto decoded =
        decode_multicast(std::span(datagram).first(static_cast<std::size_t>(size)));
    if (decoded.content == MulticastContent::frame) {
      frames[count++] = decoded.frame;
      ++statistics_.frames_received;
    } else if (decoded.content != MulticastContent::error_frame) {
      ++statistics_.malformed;
    }
  }
  return count;
}

void UdpMulticastLink::send(const can::Frame& frame, base::SimTime time) {
  ++statistics_.frames_sent;
  queue(encode_multicast(frame, time + epoch_));
}

void UdpMulticastLink::send_error(const ErrorFrame& error, base::SimTime time) {
  queue(encode_multicast(error, time + epoch_));
}

void UdpMulticastLink::queue(const MulticastMessage& message) {
  if (queue_.size() == kMaximumQueued) {
    ++statistics_.frames_dropped;
    return;
  }
  queue_.push_back(message);
}

void UdpMulticastLink::flush() {
  while (!queue_.empty()) {
    const auto content = queue_.front().content();
    if (::send(sender_.get(), content.data(), content.size(), MSG_NOSIGNAL) < 0) {
      if (errno == EAGAIN || errno == ENOBUFS) {
        wait_to_write(true);
        return;
      }
      // ECONNREFUSED and the like concern a datagram sent before; a network that is gone loses all.
      ++statistics_.frames_dropped;
    }
    queue_.pop_front();
  }
  wait_to_write(false);
}

void UdpMulticastLink::wait_to_write(bool wait) {
  if (waits_to_write_ == wait) {
    return;
  }
  waits_to_write_ = wait;
  epoll_event event{};
  event.events = wait ? std::uint32_t{EPOLLOUT} : 0U;
  event.data.fd = sender_.get();
  ::epoll_ctl(waiting_.get(), EPOLL_CTL_MOD, sender_.get(), &event);
}

CanLinkStatistics UdpMulticastLink::statistics() const {
  CanLinkStatistics statistics = statistics_;
  statistics.clients = 1;
  return statistics;
}

std::string UdpMulticastLink::usage() const {
  return "can.Bus(" + python_can_arguments(address_) + ")";
}

}  // namespace stator::link
