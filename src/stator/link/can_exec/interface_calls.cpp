// How a program finds interfaces: names, indices and the requests of ioctl().

#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <ctime>

#include <linux/can.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>

#include "stator/link/can_exec/bus_interface.hpp"
#include "stator/link/can_exec/system_calls.hpp"

#define STATOR_EXPORT extern "C" __attribute__((visibility("default")))

namespace stator::link::can_exec {

namespace {

/// Answers a request about one of the buses. False: it is about something else.
bool answer_interface_request(unsigned long request, ifreq& interface) {
  if (request == SIOCGIFNAME) {
    const Bus* const bus = bus_with_index(interface.ifr_ifindex);
    if (bus != nullptr) {
      std::strncpy(interface.ifr_name, bus->name.c_str(), IFNAMSIZ - 1);
      interface.ifr_name[IFNAMSIZ - 1] = '\0';
    }
    return bus != nullptr;
  }
  char name[IFNAMSIZ + 1] = {};
  std::memcpy(name, interface.ifr_name, IFNAMSIZ);
  const Bus* const bus = bus_named(name);
  if (bus == nullptr) {
    return false;
  }
  switch (request) {
    case SIOCGIFINDEX:
      interface.ifr_ifindex = bus->index;
      return true;
    case SIOCGIFMTU:
      interface.ifr_mtu = CAN_MTU;
      return true;
    case SIOCGIFFLAGS:
      // The flags that ioctl() has room for.
      interface.ifr_flags = static_cast<short>(interface_flags(ask(*bus)) & 0xFFFF);
      return true;
    case SIOCGIFHWADDR:
      std::memset(&interface.ifr_hwaddr, 0, sizeof interface.ifr_hwaddr);
      interface.ifr_hwaddr.sa_family = ARPHRD_CAN;
      return true;
    case SIOCGIFTXQLEN:
      interface.ifr_qlen = int{kTransmitQueue};
      return true;
    case SIOCGIFMETRIC:
      interface.ifr_metric = 0;
      return true;
    default:
      return false;
  }
}

bool is_interface_request(unsigned long request) {
  return request == SIOCGIFNAME || request == SIOCGIFINDEX || request == SIOCGIFMTU ||
         request == SIOCGIFFLAGS || request == SIOCGIFHWADDR || request == SIOCGIFTXQLEN ||
         request == SIOCGIFMETRIC;
}

/// What Linux refuses a request about a CAN interface with that only others can answer: it has no
/// addresses and no link settings. 0: it may be answered.
int refusal(unsigned long request, const ifreq& interface) {
  const bool asks_address = request == SIOCGIFADDR || request == SIOCGIFDSTADDR ||
                            request == SIOCGIFBRDADDR || request == SIOCGIFNETMASK;
  if (!asks_address && request != SIOCETHTOOL) {
    return 0;
  }
  char name[IFNAMSIZ + 1] = {};
  std::memcpy(name, interface.ifr_name, IFNAMSIZ);
  if (bus_named(name) == nullptr) {
    return 0;
  }
  return asks_address ? EADDRNOTAVAIL : EOPNOTSUPP;
}

/// SIOCGSTAMP and SIOCGSTAMPNS: when the last message came.
int give_time_stamp(const ProgramSocket& socket, bool nanoseconds, void* to) {
  if (socket.received.tv_sec == 0) {
    errno = ENOENT;
    return -1;
  }
  timespec value = socket.received;
  if (!nanoseconds) {
    value.tv_nsec /= 1'000;
  }
  // timeval and timespec are both two longs where this library runs.
  static_assert(sizeof(timeval) == sizeof(timespec));
  std::memcpy(to, &value, sizeof value);
  return 0;
}

}  // namespace

}  // namespace stator::link::can_exec

using namespace stator::link::can_exec;

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the C library's are no words

STATOR_EXPORT int ioctl(int descriptor, unsigned long request, ...) noexcept {
  std::va_list arguments;
  va_start(arguments, request);
  void* const argument = va_arg(arguments, void*);
  va_end(arguments);
  if (is_interface_request(request) && argument != nullptr &&
      answer_interface_request(request, *static_cast<ifreq*>(argument))) {
    return 0;
  }
  if (argument != nullptr) {
    if (const int error = refusal(request, *static_cast<ifreq*>(argument)); error != 0) {
      errno = error;
      return -1;
    }
  }
  const auto found = ProgramSockets::instance().find(descriptor);
  if (found && argument != nullptr) {
    if (request == SIOCGSTAMP_OLD || request == SIOCGSTAMPNS_OLD) {
      return give_time_stamp(*found, request == SIOCGSTAMPNS_OLD, argument);
    }
    if (request == FIONREAD) {
      const int result = STATOR_SYSTEM(ioctl)(descriptor, request, argument);
      int& size = *static_cast<int*>(argument);
      size -= result == 0 && size > 0 ? int{sizeof(Origin)} : 0;
      return result;
    }
  }
  return STATOR_SYSTEM(ioctl)(descriptor, request, argument);
}

STATOR_EXPORT unsigned if_nametoindex(const char* name) noexcept {
  const Bus* const bus = bus_named(name);
  return bus != nullptr ? static_cast<unsigned>(bus->index) : STATOR_SYSTEM(if_nametoindex)(name);
}

STATOR_EXPORT char* if_indextoname(unsigned index, char* name) noexcept {
  const Bus* const bus = bus_with_index(static_cast<int>(index));
  if (bus == nullptr) {
    return STATOR_SYSTEM(if_indextoname)(index, name);
  }
  std::strncpy(name, bus->name.c_str(), IF_NAMESIZE - 1);
  name[IF_NAMESIZE - 1] = '\0';
  return name;
}

// NOLINTEND(readability-inconsistent-declaration-parameter-name)
