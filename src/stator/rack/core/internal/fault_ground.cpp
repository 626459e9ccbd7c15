#include "stator/rack/core/internal/fault_ground.hpp"

#include <variant>

#include "stator/rack/core/internal/rack_parts.hpp"

namespace stator::rack {

namespace {

// The member of an event that holds the value to be set.
template <typename Event>
constexpr auto kWanted = nullptr;
template <>
constexpr auto kWanted<InputEvent> = &InputEvent::value;
template <>
constexpr auto kWanted<CableEvent> = &CableEvent::intact;
template <>
constexpr auto kWanted<PowerEvent> = &PowerEvent::on;

}  // namespace

void FaultGround::apply(const RackEvent& event, base::SimTime now) {
  parts_.apply_event(event, now);
}

void FaultGround::hold(const faults::Holdable& event, const void* owner, base::SimTime now) {
  if (const auto* input = std::get_if<InputEvent>(&event)) {
    static_cast<void>(parts_.find_input(*input));  // throws before anything is noted
  }
  std::visit(
      [&]<typename Event>(const Event& wanted) {
        if (parts_.held(wanted).hold(owner, wanted.*kWanted<Event>)) {
          parts_.enforce(wanted, now);
        }
      },
      event);
}

void FaultGround::release(const faults::Holdable& event, const void* owner, base::SimTime now) {
  std::visit(
      [&]<typename Event>(Event freed) {
        auto& known = parts_.held(freed);
        if (known.release(owner)) {
          freed.*kWanted<Event> = known.value();
          parts_.enforce(freed, now);
        }
      },
      event);
}

ethercat::Segment& FaultGround::segment(std::size_t index) {
  return *parts_.segments[index].segment;
}

CanNetwork& FaultGround::bus(std::size_t index) {
  return *parts_.buses[index].network;
}

SerialLine* FaultGround::line(std::string_view link) {
  for (std::size_t i = 0; i < parts_.lines.size(); ++i) {
    if (parts_.lines[i].configuration().link == link) {
      return &parts_.lines[i];
    }
  }
  return nullptr;
}

product::EtherCatDevice& FaultGround::slave(DeviceAddress device) {
  return parts_.slave(device);
}

base::EventReporter FaultGround::reporter(const FaultConfiguration& fault) {
  if (!fault.target.device && fault.kind->scope == FaultScope::bus) {
    return {&parts_.log, parts_.buses[fault.target.bus].number};
  }
  return {&parts_.log, parts_.number_of(fault.target.device.value_or(view_.addresses().front()))};
}

}  // namespace stator::rack
