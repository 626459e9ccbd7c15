#include "stator/link/ethernet/raw_ethernet_link.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "stator/link/ethernet/machine.hpp"
#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr std::uint16_t kEtherCatEtherType = 0x88A4;

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
                                             " is down; switch it on: sudo ip link set dev " +
                                             name + " up"};
}

LinkError not_permitted(const std::string& name) {
  return {LinkErrorCode::not_permitted,
          "raw frames on " + in_quotes(name) +
              " need the privilege CAP_NET_RAW; run as root or: " + setcap_command()};
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

  if (!set_socket_option(socket, SOL_PACKET, PACKET_IGNORE_OUTGOING, int{1})) {
    return system_failure("cannot ignore own frames on " + in_quotes(name), errno);
  }
  packet_mreq promiscuous{};
  promiscuous.mr_ifindex = interface_index;
  promiscuous.mr_type = PACKET_MR_PROMISC;
  if (!set_socket_option(socket, SOL_PACKET, PACKET_ADD_MEMBERSHIP, promiscuous)) {
    return system_failure("cannot receive frames for all addresses on " + in_quotes(name), errno);
  }
  enlarge_receive_buffer(socket);
  const auto busy_poll_us = static_cast<int>(options_.busy_poll / base::SimDuration(1'000));
  if (busy_poll_us > 0 && !set_socket_option(socket, SOL_SOCKET, SO_BUSY_POLL, busy_poll_us)) {
    return fail(LinkErrorCode::not_permitted,
                "busy polling on " + in_quotes(name) +
                    " was refused: " + std::generic_category().message(errno) +
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
  return wait_.receive(*this, buffer, timeout);
}

base::Expected<ReceiveWait::Taken, LinkError> RawEthernetLink::take(std::span<std::byte> buffer,
                                                                    base::SimDuration wait) {
  const bool sleeps = wait > base::SimDuration();
  if (sleeps && !receive_timeout_.set(socket_.get(), wait)) {
    return system_failure("cannot set a timeout for " + in_quotes(options_.interface), errno);
  }
  const ssize_t length =
      ::recv(socket_.get(), buffer.data(), buffer.size(), sleeps ? 0 : MSG_DONTWAIT);
  if (length > 0) {
    counters_.count_received(static_cast<std::size_t>(length));
    return ReceiveWait::Taken{.length = static_cast<std::size_t>(length)};
  }
  const bool interrupted = length < 0 && errno == EINTR;
  if (length == 0 || errno == EAGAIN || interrupted) {
    return ReceiveWait::Taken{.interrupted = interrupted};
  }
  if (errno == ENETDOWN) {
    return base::Unexpected{interface_down(options_.interface)};
  }
  return system_failure("cannot receive from " + in_quotes(options_.interface), errno);
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
