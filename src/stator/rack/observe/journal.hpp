#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/can/port.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/rack/kept/storage_completion.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::rack {

/// Is told of everything that is done to a rack from outside, in the order in which it is done, and
/// of what the rack gives out. The state of a rack follows from its configuration and from what is
/// told here, so who repeats the same calls gets the same rack to the last bit. Every function is
/// called by who holds the rack, before the thing is done unless it says otherwise, and must not
/// throw or wait.
class Journal {
 public:
  Journal() = default;
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;
  virtual ~Journal() = default;

  /// Time moves on to `now`.
  virtual void advance(base::SimTime now) = 0;
  /// The devices have come there.
  virtual void advanced(base::SimTime now) = 0;

  virtual void frame_comes(std::size_t segment, ethercat::MasterInterface entry,
                           base::SimTime arrival, std::span<const std::byte> frame) = 0;
  /// The frame that came last or was released, as it left at `exit`; nothing: it got lost.
  virtual void frame_leaves(std::optional<ethercat::MasterInterface> exit,
                            std::span<const std::byte> frame) = 0;
  /// The firmware of the segment's devices takes what frames brought.
  virtual void bus_events(std::size_t segment, base::SimTime now) = 0;
  virtual void carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                       base::SimTime now) = 0;

  /// A program's frame comes through the `port`th port of a CAN bus.
  virtual void can_frame_comes(std::size_t bus, std::size_t port, const can::Frame& frame) = 0;
  /// Afterwards: a frame of the bus was taken from the port.
  virtual void can_frame_leaves(std::size_t bus, std::size_t port,
                                const can::TimedFrame& frame) = 0;
  /// All ports of all buses are replaced by new, empty ones.
  virtual void ports_replaced() = 0;

  virtual void bytes_come(std::size_t line, std::span<const std::byte> bytes,
                          base::SimTime now) = 0;
  /// A device of the line has sent bytes.
  virtual void bytes_leave(std::size_t line, std::span<const std::byte> bytes) = 0;

  /// Somebody lets an event happen, which is none of the timetable.
  virtual void event(const RackEvent& event, base::SimTime now) = 0;
  /// A frame that was held up comes out, as frame_leaves() then tells, and the firmware takes what
  /// it brought.
  virtual void release(std::size_t segment, base::SimTime now) = 0;
  /// Somebody asks for a fault by the keys of a [[fault]] table.
  virtual void fault(const std::string& text, base::SimTime now) = 0;
  /// Somebody ends the fault of this number; nothing: all.
  virtual void fault_cleared(std::optional<std::uint64_t> id, base::SimTime now) = 0;

  /// Somebody reads an entry of a device's dictionary, which its firmware may notice.
  virtual void object_read(DeviceAddress device, std::uint16_t index, std::uint8_t subindex) = 0;
  virtual void object_written(DeviceAddress device, std::uint16_t index, std::uint8_t subindex,
                              std::span<const std::byte> value, base::SimTime now) = 0;

  /// A device hears what has become of its order to keep something.
  virtual void completed(const StorageCompletion& completion, base::SimTime now) = 0;

  /// Somebody gives the present moment a name.
  virtual void mark(const std::string& name) = 0;
};

}  // namespace stator::rack
