#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <variant>

#include "stator/base/sim_time.hpp"
#include "stator/can/error_counters.hpp"
#include "stator/can/frame_faults.hpp"
#include "stator/ethercat/segment/frame_faults.hpp"
#include "stator/rack/world/device_address.hpp"

namespace stator::rack {

/// The cable at a port of an EtherCAT device breaks or heals; on a CAN bus the one with which the
/// device is connected to it.
struct CableEvent {
  DeviceAddress device;
  unsigned port = 0;  ///< of an EtherCAT device
  bool intact = false;
};

/// The supply of a device is switched.
struct PowerEvent {
  DeviceAddress device;
  bool on = false;
};

/// Something around a device is set: a switch is pressed, a torque acts, a supply sags.
struct InputEvent {
  DeviceAddress device;
  std::string input;  ///< one of product::Device::inputs()
  double value = 0.0;
  bool logged = true;  ///< false: one of the many small steps of a ramp
};

/// The CAN controller of a device gets into another error state.
struct ErrorStateEvent {
  DeviceAddress device;
  can::ErrorState state = can::ErrorState::error_passive;  ///< or bus_off
};

/// Something is done to the next frames of a CAN bus.
struct FrameFaultEvent {
  std::size_t bus = 0;
  std::optional<std::size_t> device{};  ///< only to frames this device of the bus sends
  can::FrameFault fault{};              ///< its sender is filled in when it happens
};

/// Something is done to the next frames of a segment that pass a port of a device.
struct SegmentFaultEvent {
  std::size_t segment = 0;
  ethercat::FrameFault fault{};
};

/// What can happen to a rack; a further kind is a further alternative.
using RackEvent = std::variant<CableEvent, PowerEvent, InputEvent, ErrorStateEvent, FrameFaultEvent,
                               SegmentFaultEvent>;

/// Something that happens at a fixed moment of simulated time.
struct EventConfiguration {
  base::SimDuration at;  ///< after the rack's power-on
  RackEvent event;
};

}  // namespace stator::rack
