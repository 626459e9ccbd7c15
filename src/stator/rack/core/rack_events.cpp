// What can happen to devices of a rack from outside, at a time of the timetable or at once.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stator/rack/core/internal/rack_parts.hpp"
#include "stator/rack/world/input_names.hpp"

namespace stator::rack {

namespace {

constexpr base::EventRule kCableBroken{"cable-broken", base::Severity::information,
                                       "the cable at port {0} is broken"};
constexpr base::EventRule kCableHealed{"cable-healed", base::Severity::information,
                                       "the cable at port {0} is whole again"};
constexpr base::EventRule kPowerOff{"power-off", base::Severity::information, "its power is off"};
constexpr base::EventRule kPowerOn{"power-on", base::Severity::information,
                                   "its power is on, it starts as after a reset"};
constexpr base::EventRule kInputSet{"input-set", base::Severity::information,
                                    "{0} is set to {1:d3} {2}"};
constexpr base::EventRule kUnitlessInputSet{"input-set", base::Severity::information,
                                            "{0} is set to {1:d3}"};
constexpr base::EventRule kHeldInputSet{
    "input-held", base::Severity::information,
    "{0} is set to {1:d3}, which it gets when the fault that holds it has ended"};
constexpr base::EventRule kDisconnected{"can-disconnected", base::Severity::information,
                                        "its cable to the CAN bus is unplugged"};
constexpr base::EventRule kConnected{"can-connected", base::Severity::information,
                                     "its cable to the CAN bus is plugged in again"};
constexpr base::EventRule kFrameFault{"can-frame-fault", base::Severity::information,
                                      "{0} of the next {1} frames"};
constexpr base::EventRule kFrameFaultOfIdentifier{
    "can-frame-fault", base::Severity::information,
    "{0} of the next {1} frames with the identifier {2:x3}"};
constexpr base::EventRule kSegmentFault{"ethercat-frame-fault", base::Severity::information,
                                        "{0} of the next {1} frames that {2} port {3}"};
std::int64_t in_thousandths(double value) {
  return std::llround(value * 1000.0);
}

base::StaticText to_text(can::FrameFaultKind kind) {
  switch (kind) {
    case can::FrameFaultKind::drop:
      return "loss";
    case can::FrameFaultKind::corrupt:
      return "destruction";
    case can::FrameFaultKind::duplicate:
      return "doubling";
    case can::FrameFaultKind::delay:
      return "delay";
  }
  return "?";
}

}  // namespace

void RackParts::apply_event(const RackEvent& event, base::SimTime now) {
  if (const auto* cable = std::get_if<CableEvent>(&event)) {
    if (held(*cable).set(cable->intact)) {
      enforce(*cable, now);
    }
  } else if (const auto* power = std::get_if<PowerEvent>(&event)) {
    if (held(*power).set(power->on)) {
      enforce(*power, now);
    }
  } else if (const auto* input = std::get_if<InputEvent>(&event)) {
    apply_input(*input, now);
  } else if (const auto* state = std::get_if<ErrorStateEvent>(&event)) {
    apply_error_state(*state, now);
  } else if (const auto* fault = std::get_if<FrameFaultEvent>(&event)) {
    apply_frame_fault(*fault, now);
  } else if (const auto* segment_fault = std::get_if<SegmentFaultEvent>(&event)) {
    apply_segment_fault(*segment_fault, now);
  }
}

const product::Input& RackParts::find_input(const InputEvent& event) const {
  const bool on_bus = event.device.kind == NetworkKind::bus;
  const std::size_t network = event.device.network;
  const auto& inputs =
      (on_bus ? buses[network].inputs : segments[network].inputs)[event.device.device];
  const auto& ranges =
      (on_bus ? buses[network].ranges : segments[network].ranges)[event.device.device];
  const std::string problem = input_problem(ranges, event.input, event.value);
  if (!problem.empty()) {
    const std::string& name = on_bus ? buses[network].network->devices()[event.device.device].name
                                     : segments[network].devices[event.device.device].name;
    throw std::runtime_error(name + ": " + problem);
  }
  return *std::ranges::find(inputs, event.input, &product::Input::name);
}

Overridable<double>& RackParts::held(const InputEvent& event) {
  return held_inputs[{event.device, event.input}];
}

Overridable<bool>& RackParts::held(const CableEvent& event) {
  return held_cables.try_emplace({event.device, event.port}, true).first->second;
}

Overridable<bool>& RackParts::held(const PowerEvent& event) {
  return held_powers.try_emplace(event.device, true).first->second;
}

void RackParts::apply_input(const InputEvent& event, base::SimTime now) {
  const product::Input& input = find_input(event);
  if (held(event).set(event.value)) {
    enforce(event, now);
  } else if (event.logged) {
    report(number_of(event.device), now, kHeldInputSet,
           {base::SharedText(input.name), in_thousandths(event.value)});
  }
}

void RackParts::enforce(const InputEvent& event, base::SimTime now) {
  const product::Input& input = find_input(event);
  if (event.logged) {
    report(
        number_of(event.device), now, input.unit.empty() ? kUnitlessInputSet : kInputSet,
        {base::SharedText(input.name), in_thousandths(event.value), base::SharedText(input.unit)});
  }
  input.set(event.value);
  if (event.device.kind == NetworkKind::bus) {
    buses[event.device.network].network->touched(event.device.device);
  }
}

void RackParts::enforce(const CableEvent& event, base::SimTime now) {
  const std::uint16_t number = number_of(event.device);
  if (event.device.kind == NetworkKind::bus) {
    report(number, now, event.intact ? kConnected : kDisconnected);
    buses[event.device.network].network->set_connected(event.device.device, event.intact);
    return;
  }
  report(number, now, event.intact ? kCableHealed : kCableBroken, {event.port});
  segments[event.device.network].segment->set_cable({event.device.device, event.port},
                                                    event.intact);
}

void RackParts::enforce(const PowerEvent& event, base::SimTime now) {
  const auto [network, device, kind] = event.device;
  const bool powered = kind == NetworkKind::bus ? buses[network].network->powered(device)
                                                : segments[network].segment->powered(device);
  if (powered == event.on) {
    return;
  }
  report(number_of(event.device), now, event.on ? kPowerOn : kPowerOff);
  const product::Device& switched =
      kind == NetworkKind::bus
          ? static_cast<const product::Device&>(*buses[network].network->devices()[device].device)
          : *segments[network].devices[device].device;
  lines.set_power(switched, event.on);
  if (kind == NetworkKind::bus) {
    buses[network].network->set_power(device, event.on, now);
    return;
  }
  segments[network].segment->set_power(device, event.on);
  segments[network].devices[device].device->set_power(event.on, now);
}

void RackParts::apply_error_state(const ErrorStateEvent& event, base::SimTime now) {
  buses[event.device.network].network->set_error_state(event.device.device, event.state, now);
}

void RackParts::apply_frame_fault(const FrameFaultEvent& event, base::SimTime now) {
  const std::uint16_t number = event.device
                                   ? number_of({event.bus, *event.device, NetworkKind::bus})
                                   : buses[event.bus].number;
  const can::FrameFault& fault = event.fault;
  report(number, now, fault.identifier ? kFrameFaultOfIdentifier : kFrameFault,
         {to_text(fault.kind), fault.frames, fault.identifier.value_or(0)});
  buses[event.bus].network->inject(event);
}

void RackParts::apply_segment_fault(const SegmentFaultEvent& event, base::SimTime now) {
  const ethercat::FrameFault& fault = event.fault;
  const std::size_t slave = fault.port.slave;
  report(number_of({event.segment, slave, NetworkKind::segment}), now, kSegmentFault,
         {fault.kind == ethercat::FrameFaultKind::drop ? base::StaticText("loss")
                                                       : base::StaticText("destruction"),
          fault.frames, fault.leaving ? base::StaticText("leave") : base::StaticText("arrive at"),
          std::int64_t{fault.port.port}});
  segments[event.segment].segment->inject(fault);
}

}  // namespace stator::rack
