#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/can/port.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::rack {

struct Command;

/// Is told of everything that is done to a rack from outside, in the order in which it is done, and
/// of what the rack gives out. The state of a rack follows from its configuration and from what is
/// told here, so who repeats the same frames and commands gets the same rack to the last bit. Every
/// function is called by who holds the rack, before the thing is done unless it says otherwise, and
/// must not throw or wait.
class Journal {
 public:
  Journal() = default;
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  virtual ~Journal() = default;

  virtual void command(const Command& command) = 0;
  /// Afterwards: an Advance has brought the devices there.
  virtual void advanced(base::SimTime now) = 0;

  virtual void frame_comes(std::size_t segment, ethercat::MasterInterface entry,
                           base::SimTime arrival, std::span<const std::byte> frame) = 0;
  /// The frame that came last or was released, as it left at `exit`; nothing: it got lost.
  virtual void frame_leaves(std::optional<ethercat::MasterInterface> exit,
                            std::span<const std::byte> frame) = 0;
  /// Afterwards: a program has its place on a bus from now on.
  virtual void port_opened(std::size_t bus, std::size_t port, bool hears_errors, bool lossy) = 0;
  /// A program leaves its place on a bus.
  virtual void port_closes(std::size_t bus, std::size_t port) = 0;
  /// Afterwards: a frame of the bus was taken from the port.
  virtual void can_frame_leaves(std::size_t bus, std::size_t port,
                                const can::TimedFrame& frame) = 0;
  /// A device of the line has sent bytes.
  virtual void bytes_leave(std::size_t line, std::span<const std::byte> bytes) = 0;
  /// Afterwards: what a chip answered to the TransferHostSpi that came last.
  virtual void host_spi_answers(std::span<const std::byte> miso) = 0;
  /// A frame of the master for the network behind a device's EoE.
  virtual void eoe_frame_leaves(DeviceAddress device, std::span<const std::byte> frame) = 0;
};

}  // namespace stator::rack
