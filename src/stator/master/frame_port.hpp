#pragma once

#include <cstddef>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/master/error.hpp"

namespace stator::master {

/// What the master needs from its surroundings: a way for frames and a notion of time. On a real
/// interface time is the machine's; on a rack inside the process it is the rack's, and waiting is
/// what lets the rack advance.
class FramePort {
 public:
  FramePort() = default;
  FramePort(const FramePort&) = delete;
  FramePort& operator=(const FramePort&) = delete;
  virtual ~FramePort() = default;

  /// Sends `frame` (whole Ethernet frame without check sequence; an empty one sends nothing) and
  /// waits at most `timeout` for the next frame to come back. Returns its length in `reply`, 0 when
  /// none came. The port need not match replies to requests: the master recognises late and
  /// duplicated frames and asks again with an empty frame. Only ErrorCode::port is used.
  virtual Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       base::SimDuration timeout) = 0;

  /// Lets time pass, e.g. until the next bus cycle.
  virtual void wait(base::SimDuration duration) = 0;

  /// The present moment; never goes back.
  [[nodiscard]] virtual base::SimTime now() = 0;
};

}  // namespace stator::master
