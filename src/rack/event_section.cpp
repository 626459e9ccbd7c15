#include "rack/event_section.hpp"

#include <set>
#include <string>

#include <fmt/format.h>

#include "can/arbitration.hpp"
#include "rack/input_names.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/text.hpp"
#include "rack/wiring.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr base::SimDuration kLatest(std::int64_t{1'000'000'000} * 86'400 * 365);

constexpr double kAnyValue = 1e12;  // the input's own range decides
/// That one fault hits.
constexpr std::int64_t kMostFrames = 1'000'000;
/// Simulated time between two steps of a ramp.
constexpr base::SimDuration kRampStep = 1_ms;

std::map<std::string, can::FrameFaultKind> frame_faults() {
  using enum can::FrameFaultKind;
  return {{"drop", drop}, {"corrupt", corrupt}, {"duplicate", duplicate}, {"delay", delay}};
}

std::set<std::string> action_names() {
  std::set<std::string> names{"break", "heal",    "power-off",    "power-on",
                              "set",   "bus-off", "error-passive"};
  for (const auto& [name, kind] : frame_faults()) {
    names.insert(name);
  }
  return names;
}

}  // namespace

DeviceAddress EventSectionReader::read_target(TomlSection& section) const {
  const std::optional<std::string> name =
      section.text({"device",
                    "Name of the device; of drop and the like: only frames this device sends, on "
                    "EtherCAT those that pass its port"});
  if (!name) {
    section.missing("device", "it names the device to which this happens");
  }
  std::set<std::string> names;
  std::optional<DeviceAddress> found;
  const auto look = [&](const std::vector<DeviceConfiguration>& devices, std::size_t network,
                        NetworkKind kind) {
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (devices[i].name == *name) {
        found = DeviceAddress{network, i, kind};
      }
      names.insert(devices[i].name);
    }
  };
  for (std::size_t i = 0; i < rack_.segments.size(); ++i) {
    look(rack_.segments[i].devices, i, NetworkKind::segment);
  }
  for (std::size_t i = 0; i < rack_.buses.size(); ++i) {
    look(rack_.buses[i].devices, i, NetworkKind::bus);
  }
  if (found) {
    return *found;
  }
  const std::string guess = closest_match(*name, names);
  section.fail_for_reference(
      "device", fmt::format("\"device\" is \"{}\"{}; the devices are: {}", *name,
                            guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                            fmt::join(names, ", ")));
}

const DeviceConfiguration& EventSectionReader::device_at(DeviceAddress address) const {
  return address.kind == NetworkKind::bus ? rack_.buses[address.network].devices[address.device]
                                          : rack_.segments[address.network].devices[address.device];
}

void EventSectionReader::require_can(TomlSection& section, DeviceAddress target) const {
  if (target.kind != NetworkKind::bus || !rack_.buses[target.network].wire) {
    section.fail("device", fmt::format("\"{}\" is on no CAN bus, so this cannot happen to it",
                                       device_at(target).name));
  }
}

DeviceAddress EventSectionReader::read_can_target(TomlSection& section) const {
  const DeviceAddress target = read_target(section);
  require_can(section, target);
  return target;
}

/// A port of an EtherCAT device with a cable, by default the one it is reached through.
unsigned EventSectionReader::read_port(TomlSection& section, DeviceAddress target) const {
  const SegmentConfiguration& segment = rack_.segments[target.network];
  const DeviceConfiguration& device = segment.devices[target.device];
  unsigned port = device.wiring.entry_port;
  if (const auto given =
          section.integer({"port", "Port at which the cable ends; by default entry_port"}, 0, 3)) {
    port = static_cast<unsigned>(*given);
  }
  if (!has_cable(segment, target.device, port)) {
    section.refuse("port", fmt::format("port {} of \"{}\" has no cable", port, device.name));
  }
  return port;
}

RackEvent EventSectionReader::read_cable(TomlSection& section, bool intact) const {
  const DeviceAddress target = read_target(section);
  if (target.kind == NetworkKind::bus && !rack_.buses[target.network].wire) {
    section.fail("device", fmt::format("\"{}\" has serial lines only, whose cables do not break",
                                       device_at(target).name));
  }
  if (target.kind == NetworkKind::bus) {
    return CableEvent{target, 0, intact};
  }
  return CableEvent{target, read_port(section, target), intact};
}

std::size_t EventSectionReader::read_bus(TomlSection& section, const std::string& name) const {
  std::set<std::string> names;
  for (std::size_t i = 0; i < rack_.buses.size(); ++i) {
    if (!rack_.buses[i].wire) {
      continue;
    }
    if (rack_.buses[i].name == name) {
      return i;
    }
    names.insert(rack_.buses[i].name);
  }
  section.fail("bus",
               fmt::format("\"bus\" is \"{}\"; the buses are: {}", name,
                           names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

RackEvent EventSectionReader::read_segment_fault(TomlSection& section, DeviceAddress target,
                                                 can::FrameFaultKind kind) const {
  using ethercat::FrameFaultKind;
  if (kind != can::FrameFaultKind::drop && kind != can::FrameFaultKind::corrupt) {
    section.refuse("action",
                   fmt::format("\"{}\" is on EtherCAT, where frames can be hit by \"drop\" and "
                               "\"corrupt\" only",
                               device_at(target).name));
  }
  SegmentFaultEvent event{target.network, {}};
  event.fault.kind =
      kind == can::FrameFaultKind::drop ? FrameFaultKind::drop : FrameFaultKind::corrupt;
  event.fault.port = {target.device, read_port(section, target)};
  event.fault.leaving =
      section.choice({"direction", "Frames that arrive at the port or that leave it"},
                     {"in", "out"}) == "out";
  event.fault.frames = static_cast<unsigned>(
      section.integer({"frames", "How many frames are hit"}, 1, kMostFrames).value_or(1));
  return event;
}

RackEvent EventSectionReader::read_frame_fault(TomlSection& section,
                                               can::FrameFaultKind kind) const {
  FrameFaultEvent event;
  event.fault.kind = kind;
  if (const auto bus = section.text(
          {"bus", "Instead of device: frames of all on this bus, those of masters too"})) {
    event.bus = read_bus(section, *bus);
  } else {
    const DeviceAddress target = read_target(section);
    if (target.kind == NetworkKind::segment) {
      return read_segment_fault(section, target, kind);
    }
    require_can(section, target);
    event.bus = target.network;
    event.device = target.device;
  }
  if (const auto frames = section.integer({"frames", "How many frames are hit"}, 1, kMostFrames)) {
    event.fault.frames = static_cast<unsigned>(*frames);
  }
  if (const auto identifier =
          section.integer({"identifier", "Only frames with this identifier, e.g. 0x601"}, 0,
                          can::kExtendedIdentifierMask)) {
    event.fault.identifier = static_cast<std::uint32_t>(*identifier);
  }
  if (kind == can::FrameFaultKind::delay) {
    const auto delay = section.duration({"delay", "How long the sender is held back"}, 1_us, 60_s);
    if (!delay) {
      section.missing("delay", "it says how long frames are held back, e.g. \"5ms\"");
    }
    event.fault.delay = *delay;
  }
  return event;
}

const EventSectionReader::Inputs& EventSectionReader::inputs_of(DeviceAddress device) {
  const auto [place, is_new] = inputs_.try_emplace(device);
  if (is_new) {
    place->second = make_device(device_at(device).product, {})->inputs();
  }
  return place->second;
}

void EventSectionReader::read_set(TomlSection& section, base::SimDuration at,
                                  std::vector<EventConfiguration>& events) {
  const DeviceAddress target = read_target(section);
  const std::optional<std::string> input =
      section.text({"input", "What is set, see stator describe DEVICE --inputs"});
  const std::optional<double> value =
      section.number({"value", "Its new value, which stays"}, -kAnyValue, kAnyValue);
  if (!input || !value) {
    section.fail(input ? "value" : "input",
                 "\"set\" needs \"input\", which names what is set, and \"value\"; \"stator "
                 "describe DEVICE --inputs\" lists the inputs");
  }
  if (section.collects_errors() && !section.errors()->list.empty()) {
    // A device with errors may not be there to be asked.
    static_cast<void>(
        section.number({"from", "A ramp begins at this value"}, -kAnyValue, kAnyValue));
    static_cast<void>(section.duration({"over", "How long the ramp takes"}, kRampStep, 60_s));
    return;
  }
  if (const std::string problem = input_problem(inputs_of(target), *input, *value);
      !problem.empty()) {
    section.refuse("value", problem);
  }
  const std::optional<double> from = section.number("from", -kAnyValue, kAnyValue);
  const std::optional<base::SimDuration> over = section.duration("over", kRampStep, 60_s);
  if (from.has_value() != over.has_value()) {
    section.refuse(from ? "from" : "over",
                   "a ramp needs both: \"from\", the value it starts at, and \"over\", how long it "
                   "takes");
  }
  if (over && from) {
    if (const std::string problem = input_problem(inputs_of(target), *input, *from);
        !problem.empty()) {
      section.refuse("from", problem);
    }
    const std::int64_t steps = *over / kRampStep;
    for (std::int64_t i = 0; i < steps; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(steps);
      events.push_back({at + kRampStep * i,
                        InputEvent{target, *input, *from + part * (*value - *from), i == 0}});
    }
    at += kRampStep * steps;
  }
  events.push_back({at, InputEvent{target, *input, *value}});
}

void EventSectionReader::read(TomlSection& section, std::vector<EventConfiguration>& events) {
  const std::optional<base::SimDuration> at =
      section.duration({"at", "When, counted from the start of the rack"}, 0_ns, kLatest);
  if (!at) {
    section.missing("at", "it says when, e.g. \"5s\" after the rack's start");
  }
  const auto action = section.selector({"action", "What happens"}, action_names());
  if (!action) {
    section.missing("action",
                    fmt::format("it must be one of: {}", fmt::join(action_names(), ", ")));
  }
  if (*action == "set") {
    read_set(section, *at, events);
  } else if (*action == "break" || *action == "heal") {
    events.push_back({*at, read_cable(section, *action == "heal")});
  } else if (*action == "power-off" || *action == "power-on") {
    events.push_back({*at, PowerEvent{read_target(section), *action == "power-on"}});
  } else if (*action == "bus-off" || *action == "error-passive") {
    const bool off = *action == "bus-off";
    events.push_back(
        {*at, ErrorStateEvent{read_can_target(section),
                              off ? can::ErrorState::bus_off : can::ErrorState::error_passive}});
  } else {
    events.push_back({*at, read_frame_fault(section, frame_faults().at(*action))});
  }
  section.finish();
}

}  // namespace stator::rack
