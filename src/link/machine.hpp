#pragma once

#include <string>
#include <vector>

#include "base/expected.hpp"
#include "link/error.hpp"

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

/// Makes the calling thread give way to those that answer frames: it leaves a real-time policy that
/// the process was started with ("chrt -f 20 stator run ...") and becomes nicer by 5.
void give_way_to_other_threads();

}  // namespace stator::link
