#include "stator/link/ethernet/udp_ethernet_link.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <linux/sock_diag.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr std::size_t kSourceAddressOffset = 6;
constexpr std::size_t kIpv4InSourceAddress = kSourceAddressOffset + 2;
constexpr std::byte kProcessedBySlaves{0x02};  // locally administered: set by the first slave

// Room for one IP_PKTINFO message.
struct ControlBuffer {
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(in_pktinfo))> bytes{};
};

std::string addresses_of_this_machine() {
  std::string list;
  ifaddrs* interfaces = nullptr;
  if (::getifaddrs(&interfaces) != 0) {
    return "unknown";
  }
  for (const ifaddrs* each = interfaces; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) {
      continue;
    }
    std::array<char, INET_ADDRSTRLEN> text{};
    const auto* address = reinterpret_cast<const sockaddr_in*>(each->ifa_addr);
    ::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
    list += (list.empty() ? "" : ", ") + std::string(text.data());
  }
  ::freeifaddrs(interfaces);
  return list.empty() ? "none" : list;
}

/// An Ethernet header as if the frame had come on a cable from the machine at `sender`.
void write_ethernet_header(std::span<std::byte> header, const in_addr& sender, bool processed) {
  std::ranges::fill(header.first(kSourceAddressOffset), std::byte{0xFF});
  header[kSourceAddressOffset] = processed ? kProcessedBySlaves : std::byte{0};
  header[kSourceAddressOffset + 1] = std::byte{0};
  std::memcpy(header.data() + kIpv4InSourceAddress, &sender, sizeof sender);
  header[kEthernetHeaderLength - 2] = std::byte{kEtherCatUdpPort >> 8};  // also the EtherType
  header[kEthernetHeaderLength - 1] = std::byte{kEtherCatUdpPort & 0xFF};
}

/// The address of this machine at which `message` arrived; of a broadcast, the interface's own.
in_addr local_address_of(msghdr& message) {
  for (cmsghdr* each = CMSG_FIRSTHDR(&message); each != nullptr;
       each = CMSG_NXTHDR(&message, each)) {
    if (each->cmsg_level == IPPROTO_IP && each->cmsg_type == IP_PKTINFO) {
      in_pktinfo information{};
      std::memcpy(&information, CMSG_DATA(each), sizeof information);
      return information.ipi_spec_dst;
    }
  }
  return {};
}

/// Lets `message` leave from `local`.
void set_local_address(msghdr& message, ControlBuffer& control, const in_addr& local) {
  message.msg_control = control.bytes.data();
  message.msg_controllen = control.bytes.size();
  cmsghdr* header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = IPPROTO_IP;
  header->cmsg_type = IP_PKTINFO;
  header->cmsg_len = CMSG_LEN(sizeof(in_pktinfo));
  in_pktinfo information{};
  information.ipi_spec_dst = local;
  std::memcpy(CMSG_DATA(header), &information, sizeof information);
}

}  // namespace

UdpEthernetLink::UdpEthernetLink(const UdpEthernetOptions& options, End end)
    : options_(options),
      end_(end),
      name_("udp:" + options.address + ":" + std::to_string(options.port)),
      wait_(options.wait, options.spin_time) {}

base::Expected<std::unique_ptr<UdpEthernetLink>, LinkError> UdpEthernetLink::listen(
    const UdpEthernetOptions& options) {
  auto link = std::unique_ptr<UdpEthernetLink>(new UdpEthernetLink(options, End::slaves));
  const auto address = link->open_socket();
  if (!address) {
    return base::Unexpected{address.error()};
  }
  if (const auto done = link->bind_to(*address); !done) {
    return base::Unexpected{done.error()};
  }
  return link;
}

base::Expected<std::unique_ptr<UdpEthernetLink>, LinkError> UdpEthernetLink::connect(
    const UdpEthernetOptions& options) {
  auto link = std::unique_ptr<UdpEthernetLink>(new UdpEthernetLink(options, End::master));
  const auto address = link->open_socket();
  if (!address) {
    return base::Unexpected{address.error()};
  }
  if (const auto done = link->connect_to(*address); !done) {
    return base::Unexpected{done.error()};
  }
  return link;
}

/// Opens the socket; the options' address and port as the system wants them.
base::Expected<sockaddr_in, LinkError> UdpEthernetLink::open_socket() {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options_.port);
  if (::inet_pton(AF_INET, options_.address.c_str(), &address.sin_addr) != 1) {
    return fail(LinkErrorCode::invalid_option,
                in_quotes(options_.address) +
                    " is no IPv4 address; EtherCAT over UDP needs one in numbers, e.g. 127.0.0.1");
  }
  socket_ = FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!socket_.is_open()) {
    return system_failure("cannot open a UDP socket", errno);
  }
  enlarge_receive_buffer(socket_.get());
  return address;
}

base::Expected<void, LinkError> UdpEthernetLink::bind_to(const sockaddr_in& address) {
  if (!set_socket_option(socket_.get(), IPPROTO_IP, IP_PKTINFO, int{1})) {
    return system_failure("cannot learn where datagrams arrive", errno);
  }
  if (::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return {};
  }
  const std::string port = std::to_string(options_.port);
  switch (errno) {
    case EADDRINUSE:
      return fail(LinkErrorCode::address_in_use,
                  "another program listens at UDP port " + port + " of " + options_.address +
                      "; end it (ss -lunp shows it), or choose another port: udp:" +
                      options_.address + ":PORT");
    case EADDRNOTAVAIL:
      return fail(LinkErrorCode::address_missing,
                  options_.address + " is not an address of this machine, which has " +
                      addresses_of_this_machine() + "; udp:0.0.0.0 listens at all of them");
    case EACCES:
      return fail(LinkErrorCode::not_permitted,
                  "UDP port " + port +
                      " needs the privilege CAP_NET_BIND_SERVICE; use a port from 1024 on, "
                      "EtherCAT's is 34980");
    default:
      return system_failure("cannot listen at " + in_quotes(name_), errno);
  }
}

base::Expected<void, LinkError> UdpEthernetLink::connect_to(const sockaddr_in& address) {
  peer_ = {.address = address, .local = {}, .known = true};
  if (::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    connected_ = true;
    return {};
  }
  // So the system tells that this is a broadcast address: answers come from others.
  if (errno == EACCES && set_socket_option(socket_.get(), SOL_SOCKET, SO_BROADCAST, int{1})) {
    return {};
  }
  return system_failure("cannot reach " + in_quotes(name_), errno);
}

base::Expected<std::size_t, LinkError> UdpEthernetLink::receive(std::span<std::byte> buffer,
                                                                base::SimDuration timeout) {
  if (buffer.size() < kEthernetHeaderLength) {
    return fail(LinkErrorCode::frame_length, "the buffer for frames from " + in_quotes(name_) +
                                                 " is shorter than an Ethernet header");
  }
  return wait_.receive(*this, buffer, timeout);
}

base::Expected<ReceiveWait::Taken, LinkError> UdpEthernetLink::take(std::span<std::byte> buffer,
                                                                    base::SimDuration wait) {
  const bool sleeps = wait > base::SimDuration();
  if (sleeps && !receive_timeout_.set(socket_.get(), wait)) {
    return system_failure("cannot set a timeout for " + in_quotes(name_), errno);
  }
  const std::span<std::byte> payload = buffer.subspan(kEthernetHeaderLength);
  sockaddr_in sender{};
  ControlBuffer control;
  iovec part{.iov_base = payload.data(), .iov_len = payload.size()};
  msghdr message{};
  message.msg_name = &sender;
  message.msg_namelen = sizeof sender;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.bytes.data();
  message.msg_controllen = control.bytes.size();
  const ssize_t received = ::recvmsg(socket_.get(), &message, sleeps ? 0 : MSG_DONTWAIT);
  if (received < 0) {
    if (errno == EAGAIN || errno == EINTR) {
      return ReceiveWait::Taken{.interrupted = errno == EINTR};
    }
    return base::Unexpected{receive_failure(errno)};
  }
  write_ethernet_header(buffer.first(kEthernetHeaderLength), sender.sin_addr, end_ == End::master);
  if (end_ == End::slaves) {
    const std::scoped_lock lock(peer_mutex_);
    peer_ = {.address = sender, .local = local_address_of(message), .known = true};
  }
  const std::size_t length = kEthernetHeaderLength + static_cast<std::size_t>(received);
  counters_.count_received(length);
  return ReceiveWait::Taken{.length = length};
}

base::Expected<void, LinkError> UdpEthernetLink::send(std::span<const std::byte> frame) {
  Peer peer;
  {
    const std::scoped_lock lock(peer_mutex_);
    peer = peer_;
  }
  if (!peer.known || frame.size() < kEthernetHeaderLength || frame.size() > kMaximumFrameLength) {
    counters_.count_send_error();
    return base::Unexpected{send_failure(peer.known ? EMSGSIZE : EDESTADDRREQ, frame.size())};
  }
  const std::span<const std::byte> payload = frame.subspan(kEthernetHeaderLength);
  iovec part{.iov_base = const_cast<std::byte*>(payload.data()), .iov_len = payload.size()};
  ControlBuffer control;
  msghdr message{};
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  if (!connected_) {
    message.msg_name = &peer.address;
    message.msg_namelen = sizeof peer.address;
  }
  if (end_ == End::slaves) {
    set_local_address(message, control, peer.local);
  }
  if (::sendmsg(socket_.get(), &message, MSG_DONTWAIT) >= 0) {
    counters_.count_sent(frame.size());
    return {};
  }
  const int error = errno;
  counters_.count_send_error();
  return base::Unexpected{send_failure(error, frame.size())};
}

LinkError UdpEthernetLink::nobody_listens() const {
  return {LinkErrorCode::peer_missing,
          "nobody listens at UDP port " + std::to_string(options_.port) + " of " +
              options_.address + "; start the slaves first: stator run ... --link " + name_};
}

LinkError UdpEthernetLink::receive_failure(int error) const {
  return error == ECONNREFUSED
             ? nobody_listens()
             : system_failure("cannot receive at " + in_quotes(name_), error).error;
}

LinkError UdpEthernetLink::send_failure(int error, std::size_t length) const {
  switch (error) {
    case EDESTADDRREQ:
      return {LinkErrorCode::peer_missing,
              in_quotes(name_) + " has nobody to answer; no frame has come yet"};
    case ECONNREFUSED:
      return nobody_listens();
    case EMSGSIZE:
      return {LinkErrorCode::frame_length,
              in_quotes(name_) + " does not carry a frame of " + std::to_string(length) + " bytes"};
    case EAGAIN:
    case ENOBUFS:
      return {LinkErrorCode::queue_full,
              "the send queue of " + in_quotes(name_) + " is full; the frame was dropped"};
    default:
      return system_failure("cannot send to " + in_quotes(name_), error).error;
  }
}

LinkStatistics UdpEthernetLink::statistics() const {
  LinkStatistics statistics = counters_.snapshot();
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (::getsockopt(socket_.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0) {
    statistics.frames_dropped = memory[SK_MEMINFO_DROPS];
  }
  return statistics;
}

std::uint16_t UdpEthernetLink::local_port() const {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace stator::link
