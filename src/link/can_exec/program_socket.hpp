#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <linux/can.h>

#include "link/can_exec_protocol.hpp"

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

/// The CAN sockets of this process by descriptor.
class ProgramSockets {
 public:
  /// Never destroyed, since programs close descriptors until the very end.
  static ProgramSockets& instance();

  /// Null if `descriptor` is none of them.
  [[nodiscard]] std::shared_ptr<ProgramSocket> find(int descriptor);
  void add(int descriptor, std::shared_ptr<ProgramSocket> socket);
  void remove(int descriptor);

 private:
  static constexpr int kQuick = 65536;

  std::mutex mutex_;
  std::map<int, std::shared_ptr<ProgramSocket>> sockets_;
  /// Lets all other descriptors pass without the lock.
  std::atomic<bool> known_[kQuick] = {};
};

}  // namespace stator::link::can_exec
