// The lists of interfaces that the C library makes, with the buses at their end.

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <ifaddrs.h>
#include <linux/if_link.h>
#include <net/if.h>

#include "stator/link/can_exec/bus_interface.hpp"
#include "stator/link/can_exec/system_calls.hpp"

#define STATOR_EXPORT extern "C" __attribute__((visibility("default")))

namespace stator::link::can_exec {

namespace {

/// What getifaddrs() returns for a bus. Interfaces of CAN have no address.
struct ListedBus {
  ifaddrs entry{};
  rtnl_link_stats statistics{};
  char name[IF_NAMESIZE] = {};
};

/// Of one call of getifaddrs().
using ListedBuses = std::vector<ListedBus>;

/// Those that freeifaddrs() has not been called for.
struct GivenLists {
  std::mutex mutex;
  std::vector<std::unique_ptr<ListedBuses>> lists;
};

GivenLists& given_lists() {
  static auto* const lists = new GivenLists;
  return *lists;
}

std::unique_ptr<ListedBuses> list_buses() {
  auto list = std::make_unique<ListedBuses>(buses().size());
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Bus& bus = buses()[i];
    const InterfaceState state = ask(bus);
    ListedBus& listed = (*list)[i];
    std::strncpy(listed.name, bus.name.c_str(), sizeof listed.name - 1);
    listed.statistics.rx_packets = static_cast<std::uint32_t>(state.port.frames_received);
    listed.statistics.rx_bytes = static_cast<std::uint32_t>(state.port.bytes_received);
    listed.statistics.tx_packets = static_cast<std::uint32_t>(state.port.frames_sent);
    listed.statistics.tx_bytes = static_cast<std::uint32_t>(state.port.bytes_sent);
    listed.entry.ifa_name = listed.name;
    listed.entry.ifa_flags = interface_flags(state);
    listed.entry.ifa_data = &listed.statistics;
    listed.entry.ifa_next = i + 1 < list->size() ? &(*list)[i + 1].entry : nullptr;
  }
  return list;
}

/// Cuts the buses off a list of getifaddrs().
void take_off(ifaddrs*& first) {
  GivenLists& given = given_lists();
  const std::scoped_lock lock(given.mutex);
  for (ifaddrs** place = &first; *place != nullptr; place = &(*place)->ifa_next) {
    for (auto list = given.lists.begin(); list != given.lists.end(); ++list) {
      if (*place == &(*list)->front().entry) {
        *place = nullptr;
        given.lists.erase(list);
        return;
      }
    }
  }
}

}  // namespace

}  // namespace stator::link::can_exec

using namespace stator::link::can_exec;

// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name): the C library's are no words

STATOR_EXPORT struct if_nameindex* if_nameindex() noexcept {
  struct if_nameindex* const machine = STATOR_SYSTEM(if_nameindex)();
  if (machine == nullptr || buses().empty()) {
    return machine;
  }
  std::size_t count = 0;
  while (machine[count].if_index != 0 || machine[count].if_name != nullptr) {
    ++count;
  }
  // As if_freenameindex() takes it: the array and each name from malloc().
  auto* const all = static_cast<struct if_nameindex*>(
      std::realloc(machine, (count + buses().size() + 1) * sizeof *machine));
  if (all == nullptr) {
    return machine;
  }
  for (const Bus& bus : buses()) {
    all[count++] = {.if_index = static_cast<unsigned>(bus.index),
                    .if_name = ::strdup(bus.name.c_str())};
  }
  all[count] = {};
  return all;
}

STATOR_EXPORT int getifaddrs(ifaddrs** first) noexcept {
  const int result = STATOR_SYSTEM(getifaddrs)(first);
  if (result != 0 || buses().empty()) {
    return result;
  }
  auto list = list_buses();
  ifaddrs** end = first;
  while (*end != nullptr) {
    end = &(*end)->ifa_next;
  }
  *end = &list->front().entry;
  GivenLists& given = given_lists();
  const std::scoped_lock lock(given.mutex);
  given.lists.push_back(std::move(list));
  return 0;
}

STATOR_EXPORT void freeifaddrs(ifaddrs* first) noexcept {
  if (first != nullptr && !buses().empty()) {
    take_off(first);
  }
  STATOR_SYSTEM(freeifaddrs)(first);
}

// NOLINTEND(readability-inconsistent-declaration-parameter-name)
