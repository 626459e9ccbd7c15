#include "rack/rack.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "rack/input_names.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/wiring.hpp"

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
constexpr base::EventRule kCarrierLost{
    "carrier-lost", base::Severity::warning,
    "the {0} network interface has no carrier: the other end is unplugged or switched off"};
constexpr base::EventRule kCarrierBack{"carrier-back", base::Severity::information,
                                       "the {0} network interface has a carrier"};

}  // namespace

Rack::Rack(const RackConfiguration& configuration, EventLog& log)
    : log_(log), timetable_(configuration.events) {
  std::vector<std::string> names;
  if (!configuration.state.empty()) {
    storage_ = std::make_unique<DeviceStorage>(configuration.state);
  }
  for (const SegmentConfiguration& segment : configuration.segments) {
    SegmentMembers members;
    members.segment = std::make_unique<ethercat::Segment>();
    members.first_device = static_cast<std::uint16_t>(names.size());
    for (const DeviceConfiguration& device : segment.devices) {
      const base::EventReporter reporter(&log, static_cast<std::uint16_t>(names.size()));
      names.push_back(device.name);
      log.set_device_names(names);
      members.devices.push_back({device.name, make_device(device.product, reporter)});
      members.inputs.push_back(members.devices.back().device->inputs());
      if (storage_ != nullptr) {
        storage_->attach(device.name, *members.devices.back().device, reporter);
      }
      ethercat::SlaveController& controller = members.devices.back().device->controller();
      if (device.forwarding_delay) {
        controller.set_forwarding_delay(*device.forwarding_delay);
      }
      members.segment->add(controller);
    }
    connect(*members.segment, segment);
    members.segment->set_carrier(ethercat::MasterInterface::secondary, false);
    segments_.push_back(std::move(members));
  }
  for (const EventConfiguration& event : configuration.events) {
    if (const auto* input = std::get_if<InputEvent>(&event.event)) {
      static_cast<void>(find_input(*input));
    }
  }
  if (configuration.record) {
    recorder_.emplace(configuration.record->file,
                      select_signals(signals(), configuration.record->signals),
                      configuration.record->period);
  }
}

std::optional<ethercat::MasterInterface> Rack::process_frame(std::size_t segment,
                                                             std::span<std::byte> frame,
                                                             base::SimTime arrival,
                                                             ethercat::MasterInterface entry) {
  if (timetable_.next() <= arrival) [[unlikely]] {
    advance(arrival);
  }
  return segments_[segment].segment->process(frame, arrival, entry);
}

void Rack::handle_bus_events(std::size_t segment, base::SimTime now) {
  for (NamedDevice& member : segments_[segment].devices) {
    member.device->handle_bus_events(now);
  }
}

void Rack::advance(base::SimTime now) {
  const auto next_sample = [this] {
    return recorder_ ? recorder_->next_sample() : base::SimTime::never();
  };
  while (std::min(timetable_.next(), next_sample()) <= now) {
    const base::SimTime instant = std::min(timetable_.next(), next_sample());
    advance_devices(instant);
    while (timetable_.next() <= instant) {
      apply(timetable_.take(), instant);
    }
    if (next_sample() <= instant) {
      recorder_->sample(instant);
    }
  }
  advance_devices(now);
}

void Rack::apply(const RackEvent& event, base::SimTime now) {
  if (const auto* cable = std::get_if<CableEvent>(&event)) {
    apply_cable(*cable, now);
  } else if (const auto* power = std::get_if<PowerEvent>(&event)) {
    apply_power(*power, now);
  } else if (const auto* input = std::get_if<InputEvent>(&event)) {
    apply_input(*input, now);
  }
}

const devices::Input& Rack::find_input(const InputEvent& event) const {
  const SegmentMembers& members = segments_[event.device.segment];
  const std::vector<devices::Input>& inputs = members.inputs[event.device.device];
  const std::string problem = input_problem(inputs, event.input, event.value);
  if (!problem.empty()) {
    throw std::runtime_error(members.devices[event.device.device].name + ": " + problem);
  }
  return *std::ranges::find(inputs, event.input, &devices::Input::name);
}

void Rack::apply_input(const InputEvent& event, base::SimTime now) {
  const devices::Input& input = find_input(event);
  if (event.logged) {
    report(event.device, now, input.unit.empty() ? kUnitlessInputSet : kInputSet,
           {std::string_view(input.name), std::int64_t{std::llround(event.value * 1000.0)},
            std::string_view(input.unit)});
  }
  input.set(event.value);
}

void Rack::apply_cable(const CableEvent& event, base::SimTime now) {
  report(event.device, now, event.intact ? kCableHealed : kCableBroken, {event.port});
  segments_[event.device.segment].segment->set_cable({event.device.device, event.port},
                                                     event.intact);
}

void Rack::apply_power(const PowerEvent& event, base::SimTime now) {
  SegmentMembers& members = segments_[event.device.segment];
  if (members.segment->powered(event.device.device) == event.on) {
    return;
  }
  report(event.device, now, event.on ? kPowerOn : kPowerOff);
  members.segment->set_power(event.device.device, event.on);
  members.devices[event.device.device].device->set_power(event.on, now);
}

void Rack::set_carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                       base::SimTime now) {
  const bool primary = interface == ethercat::MasterInterface::primary;
  const std::size_t at = primary ? 0 : segments_[segment].devices.size() - 1;
  report({segment, at}, now, up ? kCarrierBack : kCarrierLost, {primary ? "primary" : "secondary"});
  segments_[segment].segment->set_carrier(interface, up);
}

void Rack::report(DeviceAddress device, base::SimTime now, const base::EventRule& rule,
                  const Arguments& arguments) {
  const std::size_t number = segments_[device.segment].first_device + device.device;
  log_.on_event({now, &rule, static_cast<std::uint16_t>(number), arguments});
}

void Rack::advance_devices(base::SimTime now) {
  for (SegmentMembers& members : segments_) {
    for (NamedDevice& member : members.devices) {
      member.device->advance(now);
    }
  }
}

std::vector<devices::Signal> Rack::signals() {
  std::vector<devices::Signal> all;
  for (SegmentMembers& members : segments_) {
    for (NamedDevice& member : members.devices) {
      for (devices::Signal signal : member.device->signals()) {
        signal.name = member.name + "." + signal.name;
        all.push_back(std::move(signal));
      }
    }
  }
  return all;
}

}  // namespace stator::rack
