#pragma once

#include <cstddef>
#include <limits>

#include "stator/can/frame.hpp"

namespace stator::can {

/// What a node sends through: the transmit buffer of its CAN controller.
class Transmitter {
 public:
  Transmitter() = default;
  Transmitter(const Transmitter&) = delete;
  Transmitter& operator=(const Transmitter&) = delete;
  virtual ~Transmitter() = default;

  /// Queues `frame` behind what waits already. False: the buffer is full, the frame is lost.
  virtual bool send(const Frame& frame) = 0;
  /// How many frames can be sent now without loss. Who sends many at a time asks and waits.
  [[nodiscard]] virtual std::size_t room() const { return std::numeric_limits<std::size_t>::max(); }
};

}  // namespace stator::can
