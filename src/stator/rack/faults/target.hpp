#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/declaration.hpp"
#include "stator/product/device/input.hpp"
#include "stator/rack/faults/fault_configuration.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::ethercat {
class Segment;
}
namespace stator::product {
class Device;
class EtherCatDevice;
}  // namespace stator::product

namespace stator::rack {
class CanNetwork;
class SerialLine;
}  // namespace stator::rack

namespace stator::rack::faults {

/// What a fault can hold: an input, a cable, a supply.
using Holdable = std::variant<InputEvent, CableEvent, PowerEvent>;

/// What faults can reach. Whoever has devices and networks implements it; addresses are those of
/// its configuration.
class Target {
 public:
  Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual ~Target() = default;

  /// Lets an event happen as a timetable does. Throws std::runtime_error for an input that does not
  /// exist or a value it cannot have.
  virtual void apply(const RackEvent& event, base::SimTime now) = 0;
  /// From now on the fault that `owner` identifies holds what `event` names at the value in
  /// `event`, whatever else sets it. Throws as apply() does. Of several holds the newest is in
  /// force.
  virtual void hold(const Holdable& event, const void* owner, base::SimTime now) = 0;
  /// Ends the hold of `owner`: what `event` names takes the value of the newest hold that is left,
  /// else the value that was set last.
  virtual void release(const Holdable& event, const void* owner, base::SimTime now) = 0;

  /// Where frames and bytes pass: faults are injected, withdrawn, counted and passing frames
  /// observed there.
  virtual ethercat::Segment& segment(std::size_t index) = 0;
  virtual CanNetwork& bus(std::size_t index) = 0;
  /// Null: there is none at this link.
  virtual SerialLine* line(std::string_view link) = 0;
  /// A device on EtherCAT: its state machine, mailbox, EEPROM.
  virtual product::EtherCatDevice& slave(DeviceAddress device) = 0;

  // What milestones wait for, and what people read.

  [[nodiscard]] virtual const std::string& name_of(DeviceAddress device) const = 0;
  [[nodiscard]] virtual const product::Device& device(DeviceAddress device) const = 0;
  [[nodiscard]] virtual const std::vector<product::InputRange>& inputs(
      DeviceAddress device) const = 0;
  [[nodiscard]] virtual bool powered(DeviceAddress device) const = 0;
  [[nodiscard]] virtual dictionary::NetworkState network_state(DeviceAddress device) const = 0;
  /// For events of the device, or of the bus, that `fault` hits.
  [[nodiscard]] virtual base::EventReporter reporter(const FaultConfiguration& fault) = 0;
};

}  // namespace stator::rack::faults
