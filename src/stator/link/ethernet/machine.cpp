#include "stator/link/ethernet/machine.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include "stator/link/system/failure.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

namespace {

NetworkInterface describe(int query_socket, const char* name) {
  NetworkInterface interface;
  interface.name = name;
  ifreq request{};
  std::strncpy(request.ifr_name, name, IFNAMSIZ - 1);
  if (::ioctl(query_socket, SIOCGIFFLAGS, &request) == 0) {
    const int flags = request.ifr_flags;
    interface.up = (flags & IFF_UP) != 0;
    interface.running = (flags & IFF_RUNNING) != 0;
    interface.loopback = (flags & IFF_LOOPBACK) != 0;
  }
  return interface;
}

std::string allowed_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  std::string list;
  if (::sched_getaffinity(0, sizeof allowed, &allowed) == 0) {
    for (unsigned processor = 0; processor < CPU_SETSIZE; ++processor) {
      if (CPU_ISSET(processor, &allowed)) {
        list += (list.empty() ? "" : ", ") + std::to_string(processor);
      }
    }
  }
  return list;
}

}  // namespace

std::vector<NetworkInterface> network_interfaces() {
  std::vector<NetworkInterface> interfaces;
  const FileDescriptor query(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (struct if_nameindex* const names = ::if_nameindex(); names != nullptr) {
    for (const struct if_nameindex* entry = names; entry->if_index != 0; ++entry) {
      interfaces.push_back(describe(query.get(), entry->if_name));
    }
    ::if_freenameindex(names);
  }
  return interfaces;
}

bool may_use_raw_sockets() {
  return FileDescriptor(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0)).is_open();
}

base::Expected<void, LinkError> pin_this_thread(unsigned processor) {
  // Before the first change: afterwards the thread's own set names one processor only.
  const std::string allowed = allowed_processors();
  cpu_set_t wanted;
  CPU_ZERO(&wanted);
  if (processor < CPU_SETSIZE) {
    CPU_SET(processor, &wanted);
  }
  if (::sched_setaffinity(0, sizeof wanted, &wanted) == 0) {
    return {};
  }
  return base::Unexpected{LinkError{LinkErrorCode::invalid_option,
                                    "cannot run on processor " + std::to_string(processor) + " (" +
                                        std::generic_category().message(errno) +
                                        "); this thread may run on: " + allowed}};
}

namespace {

base::Expected<void, LinkError> set_policy(int policy, int priority) {
  const sched_param parameters{.sched_priority = priority};
  if (::sched_setscheduler(0, policy, &parameters) == 0) {
    return {};
  }
  const int error = errno;
  const std::string what = "real-time priority " + std::to_string(priority);
  if (error != EPERM && error != EACCES) {
    return system_failure("cannot have " + what, error);
  }
  return fail(LinkErrorCode::not_permitted,
              what + " is not permitted; run as root, allow it once with \"" +
                  setcap_command(kAllPrivileges) + "\", or let your user have it (ulimit -r " +
                  std::to_string(priority) +
                  ", rtprio in /etc/security/limits.conf). A container needs the capability "
                  "SYS_NICE");
}

/// Less than before needs no privilege, so this cannot fail.
void leave_real_time() {
  const sched_param none{};
  static_cast<void>(::sched_setscheduler(0, SCHED_OTHER, &none));
}

}  // namespace

base::Expected<void, LinkError> run_in_real_time(int priority) {
  return set_policy(SCHED_FIFO | SCHED_RESET_ON_FORK, priority);
}

base::Expected<void, LinkError> may_run_in_real_time(int priority) {
  // Without SCHED_RESET_ON_FORK, which a thread cannot take back without privilege.
  auto permitted = set_policy(SCHED_FIFO, priority);
  leave_real_time();
  return permitted;
}

base::Expected<void, LinkError> lock_memory() {
  // Pages stay once they are used. Not those of mappings to come (MCL_FUTURE): with a limit on
  // locked memory these would fail.
  if (::mlockall(MCL_CURRENT | MCL_ONFAULT) == 0) {
    return {};
  }
  const int error = errno;
  if (error != EPERM && error != ENOMEM) {
    return system_failure("cannot lock memory", error);
  }
  return fail(
      LinkErrorCode::not_permitted,
      "memory may not be locked, so when it gets short an answer may wait for the disk; run "
      "as root, allow it once with \"" +
          setcap_command(kAllPrivileges) + "\", or raise the limit (ulimit -l unlimited)");
}

void give_way_to_other_threads() {
  constexpr int kNicer = 5;
  leave_real_time();
  // Linux counts niceness by thread, see "C library/kernel differences" of nice(2).
  static_cast<void>(::nice(kNicer));
}

}  // namespace stator::link
