#include "stator/link/ethernet/tap_link.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"

namespace stator::link {

namespace {

constexpr const char* kDevice = "/dev/net/tun";
constexpr std::size_t kEtherTypeOffset = 12;

ifreq request_for(const std::string& interface) {
  ifreq request{};
  std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
  return request;
}

LinkError not_permitted(const std::string& interface) {
  return {LinkErrorCode::not_permitted,
          "TAP interface " + in_quotes(interface) +
              " needs the privilege CAP_NET_ADMIN; run as root, or: " + setcap_command() +
              ", or make the interface for this user before: sudo ip tuntap add dev " + interface +
              " mode tap user $USER && sudo ip link set dev " + interface + " up"};
}

LinkError device_failure(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {LinkErrorCode::interface_missing,
              std::string("there is no ") + kDevice +
                  ", so no TAP interface can be made; load it: sudo modprobe tun; for a container, "
                  "start that with --device /dev/net/tun"};
    case EACCES:
    case EPERM:
      return {LinkErrorCode::not_permitted,
              std::string(kDevice) +
                  " may not be opened by this user; run as root, or: sudo chmod "
                  "666 " +
                  kDevice};
    default:
      return system_failure(std::string("cannot open ") + kDevice, error).error;
  }
}

LinkError attach_failure(const std::string& interface, int error) {
  switch (error) {
    case EPERM:
    case EACCES:
      return not_permitted(interface);
    case EBUSY:
      return {LinkErrorCode::interface_taken, "TAP interface " + in_quotes(interface) +
                                                  " is held by another program; end that, or "
                                                  "choose another name. A master reaches what "
                                                  "runs there with ethercat:" +
                                                  interface};
    case EINVAL:
      return {LinkErrorCode::interface_taken,
              in_quotes(interface) +
                  " exists and is no TAP interface; choose another name, or reach it with "
                  "ethercat:" +
                  interface};
    default:
      return system_failure("cannot make TAP interface " + in_quotes(interface), error).error;
  }
}

void store_ipv4(sockaddr& where, const std::array<std::uint8_t, 4>& octets) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  std::memcpy(&address.sin_addr, octets.data(), octets.size());
  std::memcpy(&where, &address, sizeof address);
}

}  // namespace

base::Expected<std::unique_ptr<TapLink>, LinkError> TapLink::open(const TapOptions& options) {
  auto link = std::unique_ptr<TapLink>(new TapLink(options));
  if (const auto done = link->attach(); !done) {
    return base::Unexpected{done.error()};
  }
  if (const auto done = link->switch_on(); !done) {
    return base::Unexpected{done.error()};
  }
  return link;
}

base::Expected<std::unique_ptr<TapLink>, LinkError> TapLink::adopt(FileDescriptor descriptor,
                                                                   const TapOptions& options) {
  const int flags = ::fcntl(descriptor.get(), F_GETFL);
  if (flags < 0 || ::fcntl(descriptor.get(), F_SETFL, flags | O_NONBLOCK) != 0) {
    return system_failure("cannot use the descriptor of " + in_quotes(options.interface), errno);
  }
  auto link = std::unique_ptr<TapLink>(new TapLink(options));
  link->descriptor_ = std::move(descriptor);
  return link;
}

base::Expected<void, LinkError> TapLink::attach() {
  const std::string& interface = options_.interface;
  if (interface.empty() || interface.size() >= IFNAMSIZ ||
      interface.find_first_of("/ %") != std::string::npos) {
    return fail(LinkErrorCode::invalid_option,
                in_quotes(interface) +
                    " cannot be the name of an interface; use 1 to 15 letters and digits");
  }
  descriptor_ = FileDescriptor(::open(kDevice, O_RDWR | O_CLOEXEC | O_NONBLOCK));
  if (!descriptor_.is_open()) {
    return base::Unexpected{device_failure(errno)};
  }
  ifreq request = request_for(interface);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (::ioctl(descriptor_.get(), TUNSETIFF, &request) != 0) {
    return base::Unexpected{attach_failure(interface, errno)};
  }
  return {};
}

base::Expected<void, LinkError> TapLink::switch_on() {
  const std::string& interface = options_.interface;
  control_ = FileDescriptor(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request = request_for(interface);
  if (!control_.is_open() || ::ioctl(control_.get(), SIOCGIFFLAGS, &request) != 0) {
    return system_failure("cannot read the state of " + in_quotes(interface), errno);
  }
  if ((request.ifr_flags & IFF_UP) != 0) {
    return {};
  }
  request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
  if (::ioctl(control_.get(), SIOCSIFFLAGS, &request) == 0) {
    return {};
  }
  if (errno == EPERM || errno == EACCES) {
    return base::Unexpected{not_permitted(interface)};
  }
  return system_failure("cannot switch on " + in_quotes(interface), errno);
}

base::Expected<std::size_t, LinkError> TapLink::receive(std::span<std::byte> buffer,
                                                        base::SimDuration timeout) {
  return wait_.receive(*this, buffer, timeout);
}

base::Expected<ReceiveWait::Taken, LinkError> TapLink::take(std::span<std::byte> buffer,
                                                            base::SimDuration wait) {
  bool slept = false;
  for (;;) {
    const ssize_t length = ::read(descriptor_.get(), buffer.data(), buffer.size());
    if (length > 0) {
      const auto size = static_cast<std::size_t>(length);
      if (!wanted(buffer.first(size))) {
        continue;
      }
      counters_.count_received(size);
      return ReceiveWait::Taken{.length = size};
    }
    if (length < 0 && errno != EAGAIN && errno != EINTR) {
      return system_failure("cannot receive from TAP interface " + in_quotes(options_.interface) +
                                ", was it removed?",
                            errno);
    }
    if (slept || wait <= base::SimDuration()) {
      return ReceiveWait::Taken{};
    }
    slept = true;
    if (!sleep_until_readable(descriptor_.get(), wait)) {
      return ReceiveWait::Taken{.interrupted = true};
    }
  }
}

bool TapLink::wanted(std::span<const std::byte> frame) const {
  if (!options_.ether_type) {
    return true;
  }
  return frame.size() >= kEthernetHeaderLength &&
         frame[kEtherTypeOffset] == static_cast<std::byte>(*options_.ether_type >> 8) &&
         frame[kEtherTypeOffset + 1] == static_cast<std::byte>(*options_.ether_type & 0xFF);
}

base::Expected<void, LinkError> TapLink::send(std::span<const std::byte> frame) {
  if (frame.size() < kEthernetHeaderLength || frame.size() > kMaximumFrameLength) {
    counters_.count_send_error();
    return fail(LinkErrorCode::frame_length, in_quotes(options_.interface) +
                                                 " does not carry a frame of " +
                                                 std::to_string(frame.size()) + " bytes");
  }
  if (::write(descriptor_.get(), frame.data(), frame.size()) >= 0) {
    counters_.count_sent(frame.size());
    return {};
  }
  const int error = errno;
  counters_.count_send_error();
  switch (error) {
    case EIO:
      return fail(LinkErrorCode::interface_down,
                  "TAP interface " + in_quotes(options_.interface) +
                      " is down; switch it on: sudo ip link set dev " + options_.interface + " up");
    case EAGAIN:
    case ENOBUFS:
      return fail(LinkErrorCode::queue_full, "the queue of " + in_quotes(options_.interface) +
                                                 " is full; the frame was dropped");
    default:
      return system_failure("cannot send on " + in_quotes(options_.interface), error);
  }
}

base::Expected<void, LinkError> TapLink::set_address(const InterfaceAddress& address) {
  ifreq request = request_for(options_.interface);
  const auto set = [&](unsigned long what) { return ::ioctl(control_.get(), what, &request) == 0; };
  bool done = true;
  if (address.mac_address) {
    request.ifr_hwaddr.sa_family = ARPHRD_ETHER;
    std::memcpy(request.ifr_hwaddr.sa_data, address.mac_address->data(),
                address.mac_address->size());
    done = set(SIOCSIFHWADDR);
  }
  if (done && address.address) {
    store_ipv4(request.ifr_addr, *address.address);
    done = set(SIOCSIFADDR);
  }
  // Only an interface with an address has a mask.
  constexpr std::array<std::uint8_t, 4> kNone{};
  if (done && address.subnet_mask && address.address.value_or(kNone) != kNone) {
    store_ipv4(request.ifr_netmask, *address.subnet_mask);
    done = set(SIOCSIFNETMASK);
  }
  if (done) {
    return {};
  }
  const int error = errno;
  if (error == EPERM || error == EACCES) {
    return fail(LinkErrorCode::not_permitted,
                "the address of " + in_quotes(options_.interface) +
                    " may not be set without CAP_NET_ADMIN; run as root, or set it with: sudo ip "
                    "address add ADDRESS/PREFIX dev " +
                    options_.interface);
  }
  return system_failure("cannot set the address of " + in_quotes(options_.interface), error);
}

}  // namespace stator::link
