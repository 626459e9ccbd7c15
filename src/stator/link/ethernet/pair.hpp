#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "stator/link/ethernet/ethernet_link.hpp"

namespace stator::link {

/// Two Ethernet links joined by a cable inside the process: what one end sends the other receives,
/// in order. For tests and for racks without an interface. The ends may be used by one thread
/// (with timeouts of 0) or by two.
class Pair {
 public:
  /// `capacity` frames fit into each direction; a frame sent beyond that is refused (queue_full)
  /// and counted as dropped at the receiving end.
  explicit Pair(std::size_t capacity = 64);
  ~Pair();
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;

  [[nodiscard]] EthernetLink& first();
  [[nodiscard]] EthernetLink& second();

 private:
  class Queue;
  class End;

  std::array<std::unique_ptr<Queue>, 2> queues_;
  std::array<std::unique_ptr<End>, 2> ends_;
};

}  // namespace stator::link
