#include "stator/rack/core/internal/rack_parts.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/wiring.hpp"

namespace stator::rack {

RackParts::RackParts(const RackConfiguration& configuration, EventLog& events)
    : log(events), outputs(events), lines(configuration.lines), timetable(configuration.events) {}

// The members of a segment, as those of a bus, are stored before their devices are made: when a
// kept file is refused and an exception is thrown, the storage, which is destroyed first, still
// refers to devices that exist.
void RackParts::add(const SegmentConfiguration& segment, std::vector<std::string>& names) {
  SegmentMembers& members = segments.emplace_back();
  members.segment = std::make_unique<ethercat::Segment>();
  members.first_device = static_cast<std::uint16_t>(names.size());
  for (const DeviceConfiguration& device : segment.devices) {
    const base::EventReporter reporter(&log, static_cast<std::uint16_t>(names.size()));
    names.push_back(device.name);
    log.set_device_names(names);
    members.devices.push_back({device.name, make_ethercat_device(device.setup, reporter)});
    members.inputs.push_back(members.devices.back().device->inputs());
    members.ranges.emplace_back(members.inputs.back().begin(), members.inputs.back().end());
    if (storage != nullptr) {
      storage->attach(device.name, *members.devices.back().device, reporter);
    }
    ethercat::SlaveController& controller = members.devices.back().device->controller();
    // The only input that faults hold and that a rack file can preset, so it begins with that
    // value.
    held_inputs[{{segments.size() - 1, members.devices.size() - 1, NetworkKind::segment},
                 product::EtherCatDevice::kClockDeviation}] =
        Overridable<double>(controller.configuration().clock_deviation_ppb);
    if (device.forwarding_delay) {
      controller.set_forwarding_delay(*device.forwarding_delay);
    }
    members.segment->add(controller);
    if (ethercat::EoeServer* eoe = members.devices.back().device->eoe();
        eoe != nullptr && !device.eoe_interface.empty()) {
      const DeviceAddress address{segments.size() - 1, members.devices.size() - 1,
                                  NetworkKind::segment};
      auto& port = eoe_ports[address] = std::make_unique<EoePort>(address);
      eoe->connect(port.get());
    }
  }
  connect(*members.segment, segment);
  members.segment->set_carrier(ethercat::MasterInterface::secondary, false);
}

void RackParts::add(const BusConfiguration& bus, std::vector<std::string>& names) {
  BusMembers& members = buses.emplace_back();
  members.wire = bus.wire;
  members.number = static_cast<std::uint16_t>(names.size() + bus.devices.size());
  members.network = std::make_unique<CanNetwork>(bus);
  members.network->add_files_to(outputs, members.number);
  members.first_device = static_cast<std::uint16_t>(names.size());
  for (const DeviceConfiguration& device : bus.devices) {
    const base::EventReporter reporter(&log, static_cast<std::uint16_t>(names.size()));
    names.push_back(device.name);
    log.set_device_names(names);
    NamedCanDevice member{device.name, make_can_device(device.setup, reporter)};
    members.inputs.push_back(member.device->inputs());
    members.ranges.emplace_back(members.inputs.back().begin(), members.inputs.back().end());
    if (storage != nullptr) {
      storage->attach(device.name, device.setup.product().identity().name(), *member.device,
                      reporter);
    }
    members.network->add(std::move(member), reporter);
    members.network->set_connected(members.inputs.size() - 1, bus.wire);
  }
  names.push_back(bus.name);
  log.set_device_names(names);
}

void RackParts::connect_lines(const RackConfiguration& configuration) {
  for (std::size_t segment = 0; segment < segments.size(); ++segment) {
    for (std::size_t i = 0; i < segments[segment].devices.size(); ++i) {
      lines.add({configuration.segments[segment].devices[i], *segments[segment].devices[i].device});
    }
  }
  for (std::size_t bus = 0; bus < buses.size(); ++bus) {
    CanNetwork& network = *buses[bus].network;
    for (std::size_t i = 0; i < network.devices().size(); ++i) {
      lines.add({configuration.buses[bus].devices[i], *network.devices()[i].device, &network, i});
    }
  }
}

void RackParts::begin_trace(const TraceConfiguration& configuration, ClockKind clock) {
  std::set<std::string> names;
  for (SegmentMembers& members : segments) {
    for (NamedDevice& member : members.devices) {
      const std::optional<product::TracedPins> pins = member.device->traced_pins();
      if (pins && (configuration.device.empty() || configuration.device == member.name)) {
        trace = std::make_unique<PinTrace>(*pins, configuration, clock);
        outputs.add(trace->output(),
                    {.name = "trace " + configuration.file,
                     .records = "pieces",
                     .device = static_cast<std::uint16_t>(members.first_device +
                                                          (&member - members.devices.data())),
                     .always_waits = true});
        return;
      }
      if (pins) {
        names.insert(member.name);
      }
    }
  }
  if (names.empty()) {
    throw std::runtime_error("there is nothing to trace: the rack has no TMC8461");
  }
  throw std::runtime_error("there is no TMC8461 \"" + configuration.device +
                           "\" to trace; there is \"" + *names.begin() + "\"");
}

product::Device& RackParts::device(DeviceAddress address) {
  if (address.kind == NetworkKind::bus) {
    return *buses[address.network].network->devices()[address.device].device;
  }
  return slave(address);
}

std::uint16_t RackParts::number_of(DeviceAddress device) const {
  const std::size_t first = device.kind == NetworkKind::bus ? buses[device.network].first_device
                                                            : segments[device.network].first_device;
  return static_cast<std::uint16_t>(first + device.device);
}

void RackParts::report(std::uint16_t number, base::SimTime now, const base::EventRule& rule,
                       const Arguments& arguments) {
  log.on_event({now, &rule, number, arguments});
}

void RackParts::advance_devices(base::SimTime now) {
  for (SegmentMembers& members : segments) {
    for (NamedDevice& member : members.devices) {
      member.device->advance(now);
    }
  }
  for (BusMembers& members : buses) {
    members.network->advance(now);
  }
}

std::optional<ethercat::MasterInterface> RackParts::process_watched(
    std::size_t segment, std::span<std::byte> frame, base::SimTime arrival,
    ethercat::MasterInterface entry) {
  const auto network = static_cast<std::uint16_t>(segment);
  traffic->put(network, TrafficTap::Direction::request, arrival, frame);
  const auto exit = segments[segment].segment->process(frame, arrival, entry);
  if (exit) {
    traffic->put(network, TrafficTap::Direction::answer, arrival, frame);
  }
  return exit;
}

base::SimTime RackParts::next_coupling() const {
  base::SimTime next = base::SimTime::never();
  for (const auto& coupling : couplings) {
    next = std::min(next, coupling->next());
  }
  return next;
}

void RackParts::act_couplings(base::SimTime instant) {
  for (const auto& coupling : couplings) {
    if (coupling->next() <= instant) {
      coupling->act(instant);
    }
  }
}

base::SimTime RackParts::next_tap() const {
  base::SimTime next = base::SimTime::never();
  for (const SignalTap* tap : taps) {
    next = std::min(next, tap->next_sample());
  }
  return next;
}

void RackParts::sample_taps(base::SimTime now) {
  for (SignalTap* tap : taps) {
    if (tap->next_sample() <= now) {
      tap->sample(now);
    }
  }
}

}  // namespace stator::rack
