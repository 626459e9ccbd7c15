#include "stator/link/ethernet/abilities.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <linux/can.h>
#include <linux/capability.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "stator/link/ethernet/machine.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/link/system/machine_time.hpp"

namespace stator::link {

namespace {

/// The C library has no function for it.
bool has_capability(unsigned number) {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  __user_cap_data_struct
      data[_LINUX_CAPABILITY_U32S_3]{};  // NOLINT(*-avoid-c-arrays): the kernel's
  if (::syscall(SYS_capget, &header, &data[0]) != 0) {
    return false;
  }
  return (data[CAP_TO_INDEX(number)].effective & CAP_TO_MASK(number)) != 0;
}

/// The first line of a file of the kernel; empty if there is none.
std::string line_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// What stands behind the colon of the first line of /proc/cpuinfo that begins with `name`.
std::string processor_fact(std::string_view name) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(name)) {
      const std::size_t colon = line.find(": ");
      return colon == std::string::npos ? std::string() : line.substr(colon + 2);
    }
  }
  return {};
}

WakeUps wake_ups(std::size_t count) {
  constexpr std::chrono::milliseconds kSleep{1};
  std::vector<std::chrono::nanoseconds> late(std::max<std::size_t>(count, 1));
  for (std::chrono::nanoseconds& each : late) {
    const MachineTime until = std::chrono::steady_clock::now() + kSleep;
    const timespec moment = to_timespec(until);
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &moment, nullptr) == EINTR) {
    }
    each = std::chrono::steady_clock::now() - until;
  }
  std::ranges::sort(late);
  return {.median = late[late.size() / 2], .worst = late.back()};
}

}  // namespace

bool may_configure_interfaces() {
  return has_capability(CAP_NET_ADMIN);
}

base::Expected<void, LinkError> may_make_tap() {
  const FileDescriptor device(::open("/dev/net/tun", O_RDWR | O_CLOEXEC));
  if (!device.is_open()) {
    return system_failure("/dev/net/tun cannot be opened", errno);
  }
  // The interface goes with its descriptor.
  ifreq request{};
  std::strncpy(request.ifr_name, "doctor%d", IFNAMSIZ - 1);
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  if (::ioctl(device.get(), TUNSETIFF, &request) != 0) {
    return system_failure("no TAP interface can be made", errno);
  }
  return {};
}

bool kernel_has_can() {
  return FileDescriptor(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)).is_open();
}

std::vector<std::string> can_interfaces() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/class/net", ignored)) {
    if (line_of(entry.path() / "type") == std::to_string(ARPHRD_CAN)) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::ranges::sort(names);
  return names;
}

base::Expected<void, LinkError> may_have_pseudo_terminal() {
  const FileDescriptor master(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  if (!master.is_open() || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0) {
    return system_failure("no pseudo-terminal can be had", errno);
  }
  return {};
}

base::Expected<void, LinkError> may_lock_memory() {
  auto locked = lock_memory();
  ::munlockall();
  return locked;
}

base::Expected<void, LinkError> may_write_to(const std::string& directory) {
  std::string path = directory + "/.stator-XXXXXX";
  const FileDescriptor file(::mkostemp(path.data(), O_CLOEXEC));
  if (!file.is_open()) {
    return system_failure(directory + " takes no files", errno);
  }
  ::unlink(path.c_str());
  return {};
}

ClockFacts clock_facts() {
  constexpr int kReadings = 10'000;
  ClockFacts facts;
  facts.source = line_of("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  timespec resolution{};
  if (::clock_getres(CLOCK_MONOTONIC, &resolution) == 0) {
    facts.resolution =
        std::chrono::seconds(resolution.tv_sec) + std::chrono::nanoseconds(resolution.tv_nsec);
  }
  const MachineTime begin = std::chrono::steady_clock::now();
  MachineTime end = begin;
  for (int i = 0; i < kReadings; ++i) {
    end = std::chrono::steady_clock::now();
  }
  facts.reading = (end - begin) / kReadings;
  return facts;
}

WakeUps measure_wake_ups(std::size_t count, int priority) {
  WakeUps measured;
  // In a thread of its own: a policy is not easily taken back.
  std::jthread([&] {
    if (priority > 0) {
      static_cast<void>(run_in_real_time(priority));
    }
    measured = wake_ups(count);
  }).join();
  return measured;
}

Processors processors() {
  Processors found;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    found.usable = static_cast<std::size_t>(CPU_COUNT(&allowed));
  }
  found.model = processor_fact("model name");
  found.virtual_machine =
      (" " + processor_fact("flags") + " ").find(" hypervisor ") != std::string::npos;
  return found;
}

}  // namespace stator::link
