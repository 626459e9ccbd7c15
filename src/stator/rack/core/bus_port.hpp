#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "stator/can/frame.hpp"
#include "stator/can/port.hpp"

namespace stator::rack {

class Rack;

/// A program's place on a CAN bus of a rack. Its opening, its end and what passes are in the rack's
/// journal.
class BusPort {
 public:
  struct Options {
    bool hears_errors = true;  ///< see can::Port::set_hears_errors()
    bool lossy = false;        ///< see can::Port::set_lossy()
  };

  /// Takes the first free place of bus `bus`; `rack` must outlive the port.
  BusPort(Rack& rack, std::size_t bus, Options options);
  BusPort(Rack& rack, std::size_t bus);
  ~BusPort();
  BusPort(const BusPort&) = delete;
  BusPort& operator=(const BusPort&) = delete;

  /// A place that is open.
  struct Open {
    std::size_t bus = 0;
    std::size_t number = 0;
    Options options;
  };
  /// All of a rack, bus by bus.
  [[nodiscard]] static std::vector<Open> all(Rack& rack);

  /// The place, as command::PutCanFrame names it.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Hands a frame to the bus. False: there is no room, try again when the bus has moved on.
  bool put(const can::Frame& frame);
  [[nodiscard]] std::size_t room() const { return port_.room(); }
  /// The oldest frame of the bus that was not taken yet.
  std::optional<can::TimedFrame> take();
  [[nodiscard]] std::size_t waiting() const { return port_.waiting(); }
  /// Frames of the bus that found no room.
  [[nodiscard]] std::uint64_t lost() const { return port_.lost(); }

 private:
  friend class Rack;

  Rack& rack_;
  std::size_t bus_;
  Options options_;
  can::Port port_;
  std::size_t number_;
};

}  // namespace stator::rack
