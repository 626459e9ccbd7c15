#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include <fcntl.h>
#include <sched.h>
#include <sys/stat.h>
#include <unistd.h>

#include "stator/link/ethernet/machine.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// A network namespace of the calling thread's own, with the two ends of a veth cable named
/// "stator0" and "stator1" in it. The machine's interfaces are neither seen nor touched, and all of
/// it vanishes with the object, also when the process is killed. Threads started meanwhile share
/// it.
class VethNamespace {
 public:
  static constexpr const char* kFirst = "stator0";
  static constexpr const char* kSecond = "stator1";

  /// Nothing if the machine does not allow it; `reason` then says why and what to do. Without the
  /// program `ip` an exception.
  static std::unique_ptr<VethNamespace> create(std::string& reason) {
    if (std::system("ip -Version >/dev/null") != 0) {
      throw std::runtime_error("the program ip is missing; scripts/setup test installs it");
    }
    FileDescriptor home(::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
    if (!home.is_open() || !enter_new_namespace()) {
      reason = std::string("needs a network namespace (") + std::strerror(errno) +
               "); run as root, or allow unprivileged user namespaces";
      return nullptr;
    }
    auto created = std::unique_ptr<VethNamespace>(new VethNamespace(std::move(home)));
    if (!created->ip("link add name stator0 type veth peer name stator1") ||
        !created->ip("link set stator0 up") || !created->ip("link set stator1 up")) {
      reason = "needs a veth pair, but the kernel refuses \"ip link add ... type veth\"";
      return nullptr;
    }
    if (!created->wait_for_carrier()) {
      reason = "needs a veth pair, but its ends do not see each other";
      return nullptr;
    }
    return created;
  }

  ~VethNamespace() { [[maybe_unused]] const int result = ::setns(home_.get(), CLONE_NEWNET); }
  VethNamespace(const VethNamespace&) = delete;
  VethNamespace& operator=(const VethNamespace&) = delete;

  /// Runs iproute2's `ip` inside the namespace; false if it reports failure.
  [[nodiscard]] bool ip(const std::string& arguments) const {
    return std::system(("ip " + arguments + " 2>/dev/null").c_str()) == 0;
  }

  /// The kernel connects the ends in the background; what is sent before is lost. False if that
  /// takes longer than anybody can wait.
  static bool wait_for_carrier() {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (std::chrono::steady_clock::now() < deadline) {
      const auto interfaces = network_interfaces();
      if (std::ranges::count(interfaces, true, &NetworkInterface::running) >= 2) {
        return true;
      }
      std::this_thread::yield();
    }
    return false;
  }

 private:
  explicit VethNamespace(FileDescriptor home) : home_(std::move(home)) {}

  static bool enter_new_namespace() {
    if (::unshare(CLONE_NEWNET) == 0) {
      return true;
    }
    // Without privileges: a user namespace in which this user is root.
    const uid_t user = ::getuid();
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) {
      return false;
    }
    std::ofstream("/proc/self/uid_map") << "0 " << user << " 1\n";
    return ::getuid() == 0;
  }

  FileDescriptor home_;
};

}  // namespace stator::link
