#include "stator/link/can/socketcand_beacon.hpp"

#include <array>
#include <cerrno>
#include <tuple>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/socket_options.hpp"

namespace stator::link {

namespace {

constexpr std::uint16_t kBeaconPort = 42000;
/// At most three seconds, says the protocol.
constexpr time_t kPeriod = 2;
constexpr std::uint32_t kLoopbackBroadcast = 0x7FFFFFFF;

/// An address under which others reach a server that listens at all of them.
std::string reachable_address() {
  std::string found = "127.0.0.1";
  ifaddrs* interfaces = nullptr;
  if (::getifaddrs(&interfaces) != 0) {
    return found;
  }
  for (const ifaddrs* each = interfaces; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr != nullptr && each->ifa_addr->sa_family == AF_INET &&
        (each->ifa_flags & IFF_LOOPBACK) == 0) {
      std::array<char, INET_ADDRSTRLEN> text{};
      const auto* address = reinterpret_cast<const sockaddr_in*>(each->ifa_addr);
      ::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
      found = text.data();
      break;
    }
  }
  ::freeifaddrs(interfaces);
  return found;
}

}  // namespace

std::string socketcand_beacon(const std::string& host, const std::string& address,
                              std::uint16_t port) {
  return "<CANBeacon name=\"" + host + R"(" type="socketcand" description="Stator"><URL>can://)" +
         address + ":" + std::to_string(port) + "</URL><Bus name=\"can0\"/></CANBeacon>";
}

base::Expected<SocketcandBeacon, LinkError> SocketcandBeacon::open(const std::string& address,
                                                                   std::uint16_t port) {
  SocketcandBeacon beacon;
  in_addr listening{};
  ::inet_pton(AF_INET, address.c_str(), &listening);
  const bool local = ntohl(listening.s_addr) >> IN_CLASSA_NSHIFT == IN_LOOPBACKNET;
  beacon.to_.sin_family = AF_INET;
  beacon.to_.sin_port = htons(kBeaconPort);
  beacon.to_.sin_addr.s_addr = htonl(local ? kLoopbackBroadcast : INADDR_BROADCAST);
  beacon.socket_ = FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  beacon.timer_ = FileDescriptor(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK));
  itimerspec period{};
  period.it_value.tv_nsec = 1;
  period.it_interval.tv_sec = kPeriod;
  if (!beacon.socket_.is_open() || !beacon.timer_.is_open() ||
      !set_socket_option(beacon.socket_.get(), SOL_SOCKET, SO_BROADCAST, int{1}) ||
      ::timerfd_settime(beacon.timer_.get(), 0, &period, nullptr) != 0) {
    return system_failure("cannot broadcast the beacon of socketcand", errno);
  }
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  beacon.message_ = socketcand_beacon(
      host.data(), listening.s_addr == INADDR_ANY ? reachable_address() : address, port);
  return beacon;
}

void SocketcandBeacon::send() {
  std::uint64_t expirations = 0;
  std::ignore = ::read(timer_.get(), &expirations, sizeof expirations);
  // Without a network there is nobody to tell; the next time there may be.
  ::sendto(socket_.get(), message_.data(), message_.size(), 0,
           reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
}

}  // namespace stator::link
