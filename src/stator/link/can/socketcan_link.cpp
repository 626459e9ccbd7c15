#include "stator/link/can/socketcan_link.hpp"

#include <cerrno>
#include <tuple>
#include <utility>

#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "stator/link/can/can_link_address.hpp"
#include "stator/link/can/socketcan_frame.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/socket_options.hpp"

namespace stator::link {

namespace {

constexpr std::size_t kMaximumQueued = (std::size_t{16} << 20) / sizeof(can_frame);
constexpr long kRetryAfter = 1'000'000;  // ns; eight frames at 1 Mbit/s

}  // namespace

base::Expected<std::unique_ptr<CanLink>, LinkError> SocketCanLink::open(
    const std::string& interface) {
  auto link = std::unique_ptr<SocketCanLink>(new SocketCanLink(interface));
  if (const auto started = link->start(); !started) {
    return base::Unexpected{started.error()};
  }
  return std::unique_ptr<CanLink>(std::move(link));
}

LinkError SocketCanLink::interface_missing() const {
  return {LinkErrorCode::interface_missing, "there is no CAN interface " + in_quotes(interface_) +
                                                "; a virtual one is made by: sudo ip link add " +
                                                interface_ + " type vcan && sudo ip link set " +
                                                interface_ + " up"};
}

base::Expected<void, LinkError> SocketCanLink::start() {
  socket_ = FileDescriptor(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW));
  if (!socket_.is_open()) {
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
      return fail(LinkErrorCode::invalid_option,
                  "this kernel has no CAN (or its module is not loaded: sudo modprobe can_raw); "
                  "use another port, such as slcan:PATH, or can-exec:" +
                      interface_ + ", with which SocketCAN programs run on any kernel");
    }
    return system_failure("cannot open a CAN socket for " + in_quotes(name_), errno);
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(::if_nametoindex(interface_.c_str()));
  if (address.can_ifindex == 0) {
    return base::Unexpected{interface_missing()};
  }
  enlarge_receive_buffer(socket_.get());
  if (::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    if (errno == ENODEV) {
      return fail(LinkErrorCode::interface_taken,
                  "the interface " + in_quotes(interface_) + " is not a CAN interface");
    }
    return system_failure("cannot use the interface " + in_quotes(interface_), errno);
  }
  return wait_for_socket();
}

base::Expected<void, LinkError> SocketCanLink::wait_for_socket() {
  waiting_ = FileDescriptor(::epoll_create1(EPOLL_CLOEXEC));
  retry_ = FileDescriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  for (const int each : {socket_.get(), retry_.get()}) {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.fd = each;
    if (::epoll_ctl(waiting_.get(), EPOLL_CTL_ADD, each, &event) != 0) {
      return system_failure("cannot wait for " + in_quotes(name_), errno);
    }
  }
  return {};
}

base::Expected<std::size_t, LinkError> SocketCanLink::receive(std::span<can::Frame> frames,
                                                              base::SimTime /*now*/) {
  std::uint64_t expirations = 0;
  std::ignore = ::read(retry_.get(), &expirations, sizeof expirations);
  retry_set_ = false;
  flush();
  std::size_t count = 0;
  while (count < frames.size()) {
    can_frame frame{};
    const ssize_t size = ::read(socket_.get(), &frame, sizeof frame);
    if (size < 0) {
      if (errno == EAGAIN || errno == EINTR || errno == ENETDOWN) {
        break;  // an interface that is switched off may be switched on again
      }
      if (errno == ENODEV) {
        return base::Unexpected{interface_missing()};
      }
      return system_failure("cannot receive from " + in_quotes(name_), errno);
    }
    const auto received =
        size == sizeof frame ? from_socketcan(frame) : std::optional<can::Frame>();
    if (received) {
      frames[count++] = *received;
      ++statistics_.frames_received;
    } else {
      ++statistics_.malformed;
    }
  }
  return count;
}

void SocketCanLink::send(const can::Frame& frame, base::SimTime /*time*/) {
  ++statistics_.frames_sent;
  if (queue_.size() == kMaximumQueued) {
    ++statistics_.frames_dropped;
    return;
  }
  queue_.push_back(to_socketcan(frame));
}

void SocketCanLink::flush() {
  while (!queue_.empty()) {
    if (::write(socket_.get(), &queue_.front(), sizeof(can_frame)) < 0) {
      if (errno == EAGAIN || errno == ENOBUFS || errno == EINTR) {
        retry_soon();
        return;
      }
      ++statistics_.frames_dropped;
    }
    queue_.pop_front();
  }
}

void SocketCanLink::retry_soon() {
  if (!retry_set_) {
    retry_set_ = true;
    itimerspec once{};
    once.it_value.tv_nsec = kRetryAfter;
    ::timerfd_settime(retry_.get(), 0, &once, nullptr);
  }
}

CanLinkStatistics SocketCanLink::statistics() const {
  CanLinkStatistics statistics = statistics_;
  statistics.clients = 1;
  return statistics;
}

std::string SocketCanLink::usage() const {
  const CanLinkAddress address{.kind = CanLinkKind::socketcan, .name = interface_};
  return "can.Bus(" + python_can_arguments(address) + "), or: candump " + interface_;
}

}  // namespace stator::link
