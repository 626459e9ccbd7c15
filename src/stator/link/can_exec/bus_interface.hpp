#pragma once

#include "stator/link/can_exec/program_socket.hpp"

// A bus as the interface that programs look for: what Linux would say of it.
namespace stator::link::can_exec {

inline constexpr unsigned kTransmitQueue = 10;  ///< Linux's default for CAN interfaces

struct InterfaceState {
  bool up = false;  ///< the bus runs
  PortState port{};
};

/// Asks the bus's port. Leaves errno alone.
[[nodiscard]] InterfaceState ask(const Bus& bus);

/// IFF_ bits as in netlink messages.
[[nodiscard]] unsigned interface_flags(const InterfaceState& state);

}  // namespace stator::link::can_exec
