#include "link/raw_ethernet_link.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <time.h>

#include "link/machine.hpp"

namespace stator::link {

namespace {

constexpr std::uint16_t kEtherCatEtherType = 0x88A4;

// Room for about a thousand short frames while the process is not scheduled.
constexpr int kReceiveBufferBytes = 1 << 20;

// Longest sleep without a look at wake().
constexpr base::SimDuration kWakeInterval(20'000'000);

base::Unexpected<LinkError> fail(LinkErrorCode code, std::string text) {
  return base::Unexpected{LinkError{code, std::move(text)}};
}

base::Unexpected<LinkError> system_failure(const std::string& what, int error) {
  return fail(LinkErrorCode::system, what + ": " + std::strerror(error));
}

std::string in_quotes(const std::string& name) {
  return "\"" + name + "\"";
}

LinkError interface_missing(const std::string& name) {
  std::string existing;
  for (const NetworkInterface& interface : network_interfaces()) {
    existing += (existing.empty() ? "" : ", ") + interface.name;
  }
  return {LinkErrorCode::interface_missing,
          "there is no network interface " + in_quotes(name) +
              "; this machine has: " + (existing.empty() ? "none" : existing)};
}

LinkError interface_down(const std::string& name) {
  return {LinkErrorCode::interface_down, "network interface " + in_quotes(name) +
                                             " is down; switch it on: sudo ip link set " + name +
                                             " up"};
}

LinkError not_permitted(const std::string& name) {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return {LinkErrorCode::not_permitted,
          "raw frames on " + in_quotes(name) +
              " need the privilege CAP_NET_RAW; run as root or: sudo setcap "
              "cap_net_raw,cap_net_admin+ep " +
              program.string()};
}

std::int64_t monotonic_now() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

template <typename Value>
bool set_option(int socket, int level, int option, const Value& value) {
  return ::setsockopt(socket, level, option, &value, sizeof value) == 0;
}

}  // namespace

base::Expected<std::unique_ptr<RawEthernetLink>, LinkError> RawEthernetLink::open(
    const RawEthernetOptions& options) {
  auto link = std::unique_ptr<RawEthernetLink>(new RawEthernetLink(options));
  if (const auto done = link->set_up(); !done) {
    return base::Unexpected{done.error()};
  }
  return link;
}

base::Expected<void, LinkError> RawEthernetLink::set_up() {
  const std::string& name = options_.interface;
  if (name.empty() || name.size() >= IFNAMSIZ || ::if_nametoindex(name.c_str()) == 0) {
    return base::Unexpected{interface_missing(name)};
  }
  // Protocol 0: nothing is queued before bind() has chosen the interface.
  socket_ = FileDescriptor(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0));
  if (!socket_.is_open()) {
    return base::Unexpected{errno == EPERM || errno == EACCES
                                ? not_permitted(name)
                                : system_failure("cannot open a raw socket", errno).error};
  }
  ifreq request{};
  std::strncpy(request.ifr_name, name.c_str(), IFNAMSIZ - 1);
  if (::ioctl(socket_.get(), SIOCGIFHWADDR, &request) != 0) {
    return system_failure("cannot read the address of " + in_quotes(name), errno);
  }
  if (request.ifr_hwaddr.sa_family != ARPHRD_ETHER) {
    return fail(LinkErrorCode::invalid_option,
                "network interface " + in_quotes(name) +
                    " is not an Ethernet interface; EtherCAT "
                    "needs one, for a test without hardware use a veth pair");
  }
  std::memcpy(mac_address_.data(), request.ifr_hwaddr.sa_data, mac_address_.size());
  if (::ioctl(socket_.get(), SIOCGIFFLAGS, &request) != 0) {
    return system_failure("cannot read the state of " + in_quotes(name), errno);
  }
  if ((request.ifr_flags & IFF_UP) == 0) {
    return base::Unexpected{interface_down(name)};
  }
  return configure_socket(static_cast<int>(::if_nametoindex(name.c_str())));
}

base::Expected<void, LinkError> RawEthernetLink::configure_socket(int interface_index) {
  const std::string& name = options_.interface;
  const int socket = socket_.get();

  if (!set_option(socket, SOL_PACKET, PACKET_IGNORE_OUTGOING, int{1})) {
    return system_failure("cannot ignore own frames on " + in_quotes(name), errno);
  }
  packet_mreq promiscuous{};
  promiscuous.mr_ifindex = interface_index;
  promiscuous.mr_type = PACKET_MR_PROMISC;
  if (!set_option(socket, SOL_PACKET, PACKET_ADD_MEMBERSHIP, promiscuous)) {
    return system_failure("cannot receive frames for all addresses on " + in_quotes(name), errno);
  }
  // The forced variant needs CAP_NET_ADMIN; the plain one is bounded by the system's limit, which
  // is enough for a master that sends one frame per cycle.
  if (!set_option(socket, SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBufferBytes)) {
    set_option(socket, SOL_SOCKET, SO_RCVBUF, kReceiveBufferBytes);
  }
  const auto busy_poll_us = static_cast<int>(options_.busy_poll / base::SimDuration(1'000));
  if (busy_poll_us > 0 && !set_option(socket, SOL_SOCKET, SO_BUSY_POLL, busy_poll_us)) {
    return fail(LinkErrorCode::not_permitted,
                "busy polling on " + in_quotes(name) + " was refused: " + std::strerror(errno) +
                    "; it needs CAP_NET_ADMIN, or leave busy_poll at 0");
  }

  sockaddr_ll address{};
  address.sll_family = AF_PACKET;
  address.sll_protocol = htons(kEtherCatEtherType);
  address.sll_ifindex = interface_index;
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return system_failure("cannot use network interface " + in_quotes(name), errno);
  }
  return {};
}

base::Expected<std::size_t, LinkError> RawEthernetLink::receive(std::span<std::byte> buffer,
                                                                base::SimDuration timeout) {
  if (take_wake()) {
    return std::size_t{0};
  }
  if (timeout <= base::SimDuration(0)) {
    return take_frame(buffer, MSG_DONTWAIT);
  }
  if (options_.wait == WaitMode::block) {
    return sleep(buffer, timeout);
  }
  const std::int64_t now = monotonic_now();
  const std::int64_t end = (base::SimDuration(now) + timeout).nanoseconds();
  const std::int64_t spin_end =
      options_.wait == WaitMode::spin
          ? end
          : std::clamp(last_frame_ + options_.spin_time.nanoseconds(), now, end);
  auto received = spin(buffer, spin_end);
  if (!received || *received != 0 || take_wake() || spin_end == end) {
    return received;
  }
  return sleep(buffer, base::SimDuration(end - spin_end));
}

/// One look at the socket, or with `flags` 0 one wait of the set length; 0 when no frame came.
base::Expected<std::size_t, LinkError> RawEthernetLink::take_frame(std::span<std::byte> buffer,
                                                                   int flags) {
  interrupted_ = false;
  const ssize_t length = ::recv(socket_.get(), buffer.data(), buffer.size(), flags);
  if (length > 0) {
    counters_.count_received(static_cast<std::size_t>(length));
    if (options_.wait == WaitMode::adaptive) {
      last_frame_ = monotonic_now();
    }
    return static_cast<std::size_t>(length);
  }
  interrupted_ = length < 0 && errno == EINTR;
  if (length == 0 || errno == EAGAIN || interrupted_) {
    return std::size_t{0};
  }
  if (errno == ENETDOWN) {
    return base::Unexpected{interface_down(options_.interface)};
  }
  return system_failure("cannot receive from " + in_quotes(options_.interface), errno);
}

base::Expected<std::size_t, LinkError> RawEthernetLink::spin(std::span<std::byte> buffer,
                                                             std::int64_t until) {
  do {
    auto received = take_frame(buffer, MSG_DONTWAIT);
    if (!received || *received != 0) {
      return received;
    }
  } while (!wake_requested_.load(std::memory_order_relaxed) && monotonic_now() < until);
  return std::size_t{0};
}

/// Sleeps in recv itself: poll() and recv() would cost a seventh of the round trips that recv()
/// alone reaches when both ends share a processor. The price is that wake() is noticed between two
/// slices only.
base::Expected<std::size_t, LinkError> RawEthernetLink::sleep(std::span<std::byte> buffer,
                                                              base::SimDuration timeout) {
  while (timeout > base::SimDuration(0)) {
    const base::SimDuration slice = std::min(timeout, kWakeInterval);
    if (!set_receive_timeout(slice)) {
      return system_failure("cannot set a timeout for " + in_quotes(options_.interface), errno);
    }
    auto received = take_frame(buffer, 0);
    if (!received || *received != 0 || take_wake() || interrupted_) {
      return received;
    }
    timeout -= slice;
  }
  return std::size_t{0};
}

bool RawEthernetLink::set_receive_timeout(base::SimDuration timeout) {
  if (timeout == receive_timeout_) {
    return true;
  }
  // 0 would mean for ever.
  const std::int64_t microseconds = std::max<std::int64_t>(timeout.nanoseconds() / 1'000, 1);
  const timeval value{.tv_sec = static_cast<time_t>(microseconds / 1'000'000),
                      .tv_usec = static_cast<suseconds_t>(microseconds % 1'000'000)};
  receive_timeout_ = timeout;
  return set_option(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, value);
}

base::Expected<void, LinkError> RawEthernetLink::send(std::span<const std::byte> frame) {
  // Not waiting for room keeps a stalled medium from stalling the simulation; the frame is lost,
  // as it would be on a real line, and counted.
  if (::send(socket_.get(), frame.data(), frame.size(), MSG_DONTWAIT) >= 0) {
    counters_.count_sent(frame.size());
    return {};
  }
  const int error = errno;
  counters_.count_send_error();
  switch (error) {
    case ENETDOWN:
      return base::Unexpected{interface_down(options_.interface)};
    case EMSGSIZE:
    case EINVAL:
      return fail(LinkErrorCode::frame_length, in_quotes(options_.interface) +
                                                   " does not carry a frame of " +
                                                   std::to_string(frame.size()) + " bytes");
    case EAGAIN:
    case ENOBUFS:
      return fail(LinkErrorCode::queue_full, "the send queue of " + in_quotes(options_.interface) +
                                                 " is full; the frame was dropped");
    default:
      return system_failure("cannot send on " + in_quotes(options_.interface), error);
  }
}

void RawEthernetLink::wake() noexcept {
  wake_requested_.store(true, std::memory_order_relaxed);
}

bool RawEthernetLink::take_wake() {
  // The plain look first: an exchange for every frame would lock the bus.
  return wake_requested_.load(std::memory_order_relaxed) &&
         wake_requested_.exchange(false, std::memory_order_relaxed);
}

bool RawEthernetLink::has_carrier() const {
  ifreq request{};
  std::strncpy(request.ifr_name, options_.interface.c_str(), IFNAMSIZ - 1);
  constexpr int kConnected = IFF_UP | IFF_RUNNING;
  return ::ioctl(socket_.get(), SIOCGIFFLAGS, &request) == 0 &&
         (request.ifr_flags & kConnected) == kConnected;
}

LinkStatistics RawEthernetLink::statistics() const {
  // The kernel clears its counters with each look.
  tpacket_stats kernel{};
  socklen_t size = sizeof kernel;
  if (::getsockopt(socket_.get(), SOL_PACKET, PACKET_STATISTICS, &kernel, &size) == 0) {
    frames_dropped_ += kernel.tp_drops;
  }
  LinkStatistics statistics = counters_.snapshot();
  statistics.frames_dropped = frames_dropped_;
  return statistics;
}

}  // namespace stator::link
