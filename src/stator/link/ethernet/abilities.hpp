#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"

// What this machine lets this process do beside what machine.hpp tells: each is tried, and
// nothing of the trial stays.
namespace stator::link {

/// Whether this process may make and configure network interfaces (CAP_NET_ADMIN), e.g. veth pairs.
[[nodiscard]] bool may_configure_interfaces();

/// Whether it can make a TAP interface. The error says what is missing and what to do.
[[nodiscard]] base::Expected<void, LinkError> may_make_tap();

/// Whether the kernel has CAN (SocketCAN).
[[nodiscard]] bool kernel_has_can();
/// The machine's CAN interfaces, virtual ones among them.
[[nodiscard]] std::vector<std::string> can_interfaces();

/// Whether a pseudo-terminal can be had.
[[nodiscard]] base::Expected<void, LinkError> may_have_pseudo_terminal();

/// Whether memory may be locked (lock_memory()).
[[nodiscard]] base::Expected<void, LinkError> may_lock_memory();

/// Whether files can be made in `directory`.
[[nodiscard]] base::Expected<void, LinkError> may_write_to(const std::string& directory);

/// The clock by which a rack runs.
struct ClockFacts {
  std::string source;                     ///< of the kernel, e.g. "tsc"; empty if it is not told
  std::chrono::nanoseconds resolution{};  ///< as the kernel tells it
  std::chrono::nanoseconds reading{};     ///< how long it takes to read it
};
[[nodiscard]] ClockFacts clock_facts();

/// How late a thread wakes up that sleeps until a moment.
struct WakeUps {
  std::chrono::nanoseconds median{};
  std::chrono::nanoseconds worst{};
};
/// Of `count` sleeps of a millisecond; takes as many milliseconds. With `priority` above 0 in a
/// thread with the real-time policy, if that is permitted.
[[nodiscard]] WakeUps measure_wake_ups(std::size_t count, int priority = 0);

struct Processors {
  std::size_t usable = 0;        ///< by this process
  std::string model;             ///< empty if it is not told
  bool virtual_machine = false;  ///< a hypervisor shares them among others
};
[[nodiscard]] Processors processors();

}  // namespace stator::link
