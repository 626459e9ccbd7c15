#pragma once

#include <string>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

/// One network interface of this machine.
struct NetworkInterface {
  std::string name;
  bool up = false;       ///< switched on ("ip link set X up")
  bool running = false;  ///< has a carrier: something is at the other end
  bool loopback = false;
};

/// The machine's network interfaces in the order of their kernel numbers.
[[nodiscard]] std::vector<NetworkInterface> network_interfaces();

/// Whether this process may open raw sockets (CAP_NET_RAW).
[[nodiscard]] bool may_use_raw_sockets();

/// Ties the calling thread to one processor. The error lists the processors it may run on.
[[nodiscard]] base::Expected<void, LinkError> pin_this_thread(unsigned processor);

/// Real-time priorities that may be asked for, from the least to the most urgent.
inline constexpr int kLowestPriority = 1;
inline constexpr int kHighestPriority = 99;

/// Gives the calling thread the real-time policy SCHED_FIFO with `priority`: it runs before every
/// thread of the machine that has a lower one or none. Threads that it makes have none. The error
/// says how that is permitted.
[[nodiscard]] base::Expected<void, LinkError> run_in_real_time(int priority);

/// Whether threads of this process may call run_in_real_time(priority). The calling thread, which
/// tries it, has no real-time policy afterwards, whatever it had before; nor have those it makes.
[[nodiscard]] base::Expected<void, LinkError> may_run_in_real_time(int priority);

/// Keeps what the process has in memory from being moved to the disk or dropped, so that no thread
/// waits for that. The error says how it is permitted.
[[nodiscard]] base::Expected<void, LinkError> lock_memory();

/// Makes the calling thread give way to those that answer frames: it leaves a real-time policy that
/// the process was started with ("chrt -f 20 stator run ...") and becomes nicer by 5.
void give_way_to_other_threads();

}  // namespace stator::link
