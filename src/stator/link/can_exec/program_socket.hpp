#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <linux/can.h>

#include "stator/link/can/can_exec_protocol.hpp"
#include "stator/link/can_exec/descriptor_table.hpp"

// What the preloaded library knows of the program it is in.
namespace stator::link::can_exec {

/// A bus as the program sees it: an interface.
struct Bus {
  std::string name;
  std::string path;
  int index = 0;
};

/// The buses of kBusesVariable, read once.
[[nodiscard]] const std::vector<Bus>& buses();
/// Null if there is none.
[[nodiscard]] const Bus* bus_named(const char* name);
[[nodiscard]] const Bus* bus_with_index(int index);

/// A CAN socket of the program; descriptors made by dup() share one.
struct ProgramSocket {
  SocketKind kind = SocketKind::raw;
  std::uint8_t options = kLoopback;
  bool flexible_data_rate = false;
  std::uint32_t error_mask = 0;
  std::vector<can_filter> filters{can_filter{}};
  bool connected = false;
  /// Interface given to bind(); 0: any.
  int bound_index = 0;
  /// That of the bus it is connected to.
  int bus_index = 0;
  /// Of the broadcast manager's transmissions and receptions.
  std::set<canid_t> transmissions;
  std::set<canid_t> receptions;
  /// When a message was received last, for SIOCGSTAMP.
  timespec received{};
};

/// The CAN sockets of this process.
using ProgramSockets = DescriptorTable<ProgramSocket>;

}  // namespace stator::link::can_exec
