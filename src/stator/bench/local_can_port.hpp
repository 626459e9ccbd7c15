#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "stator/base/sim_time.hpp"
#include "stator/can/port.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/world/clock.hpp"

namespace stator::bench {

/// A master's port onto a CAN bus of a rack in the same process, in lockstep: sending moves time as
/// rack::LockstepClock has it, and waiting does. Equal runs give equal results.
class LocalCanPort {
 public:
  /// Reaches bus `bus` of `rack`, which must outlive the port.
  LocalCanPort(rack::Rack& rack, std::size_t bus, base::SimDuration cycle, base::SimDuration step);
  /// The same with a clock that ports onto other networks of the rack share; it must outlive them.
  LocalCanPort(rack::Rack& rack, std::size_t bus, rack::LockstepClock& clock);
  LocalCanPort(const LocalCanPort&) = delete;
  LocalCanPort& operator=(const LocalCanPort&) = delete;

  /// Sends a frame and lets it and what follows from it at once pass.
  void send(const can::Frame& frame);
  /// The oldest frame of the bus that was not taken yet.
  [[nodiscard]] std::optional<can::TimedFrame> receive() { return port_->take(); }
  /// Frames that receive() has not given out yet.
  [[nodiscard]] std::size_t waiting() const { return port_->waiting(); }
  /// Lets `duration` pass.
  void wait(base::SimDuration duration);
  [[nodiscard]] base::SimTime now() const { return clock_.now(); }

  /// The number of its place on the bus.
  [[nodiscard]] std::size_t number() const { return port_->number(); }
  /// Leaves the bus, since the rack ends; until take_over() nothing else may be called.
  void leave() { port_.reset(); }
  /// Goes on at this place of the rack, which was made anew.
  void take_over(std::unique_ptr<rack::BusPort> port) { port_ = std::move(port); }

 private:
  rack::Rack& rack_;
  std::size_t bus_;
  rack::LockstepClock own_clock_;
  rack::LockstepClock& clock_;
  std::unique_ptr<rack::BusPort> port_;
};

}  // namespace stator::bench
