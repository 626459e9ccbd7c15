#include "stator/rack/file/event_section.hpp"

#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "stator/can/arbitration.hpp"
#include "stator/rack/world/input_names.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr base::SimDuration kLatest(std::int64_t{1'000'000'000} * 86'400 * 365);

constexpr double kAnyValue = 1e12;  // the input's own range decides
/// The most frames that one fault can hit.
constexpr std::int64_t kMostFrames = 1'000'000;
/// Simulated time between two steps of a ramp.
constexpr base::SimDuration kRampStep = 1_ms;

/// What can happen to frames, by network: the same word means a different thing on each.
const std::map<std::string, ethercat::FrameFaultKind>& segment_faults() {
  using enum ethercat::FrameFaultKind;
  static const std::map<std::string, ethercat::FrameFaultKind> kinds{{"drop", drop},
                                                                     {"corrupt", corrupt}};
  return kinds;
}

const std::map<std::string, can::FrameFaultKind>& bus_faults() {
  using enum can::FrameFaultKind;
  static const std::map<std::string, can::FrameFaultKind> kinds{
      {"drop", drop}, {"corrupt", corrupt}, {"duplicate", duplicate}, {"delay", delay}};
  return kinds;
}

}  // namespace

const std::vector<std::string>& EventSectionReader::action_names() {
  static const std::vector<std::string> names{"set",      "break",     "heal",          "power-off",
                                              "power-on", "bus-off",   "error-passive", "drop",
                                              "corrupt",  "duplicate", "delay"};
  return names;
}

RackEvent EventSectionReader::read_cable(TableReader& section, bool intact) const {
  const DeviceAddress target = targets_.read_target(section);
  if (section.describes()) {
    return CableEvent{target, targets_.read_port(section, target), intact};
  }
  if (target.kind == NetworkKind::bus && !rack_.buses[target.network].wire) {
    section.fail("device", fmt::format("\"{}\" has serial lines only, whose cables do not break",
                                       targets_.device_at(target).name));
  }
  if (target.kind == NetworkKind::bus) {
    return CableEvent{target, 0, intact};
  }
  return CableEvent{target, targets_.read_port(section, target), intact};
}

RackEvent EventSectionReader::read_segment_fault(TableReader& section, DeviceAddress target,
                                                 const std::string& action) const {
  const auto kind = segment_faults().find(action);
  if (kind == segment_faults().end() && !section.describes()) {
    section.fail("action",
                 fmt::format("\"{}\" is on EtherCAT, where frames can be hit by \"drop\" and "
                             "\"corrupt\" only",
                             targets_.device_at(target).name));
  }
  SegmentFaultEvent event{target.network, {}};
  if (kind != segment_faults().end()) {
    event.fault.kind = kind->second;
  }
  event.fault.port = {target.device, targets_.read_port(section, target)};
  event.fault.leaving =
      section.choice({"direction", "Frames that arrive at the port or that leave it"},
                     {"in", "out"}) == "out";
  event.fault.frames = static_cast<unsigned>(
      section.integer({"frames", "How many frames are hit"}, 1, kMostFrames).value_or(1));
  return event;
}

RackEvent EventSectionReader::read_frame_fault(TableReader& section,
                                               const std::string& action) const {
  FrameFaultEvent event;
  event.fault.kind = bus_faults().at(action);
  if (const auto bus = section.text(
          {"bus", "Instead of device: frames of all on this bus, those of masters too"})) {
    event.bus = targets_.read_bus(section, *bus);
  } else {
    const DeviceAddress target = targets_.read_target(section);
    if (section.describes() && segment_faults().contains(action)) {
      static_cast<void>(read_segment_fault(section, target, action));
    } else if (target.kind == NetworkKind::segment && !section.describes()) {
      return read_segment_fault(section, target, action);
    }
    targets_.require_can(section, target);
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
  if (event.fault.kind == can::FrameFaultKind::delay) {
    const auto delay = section.duration({"delay", "How long the sender is held back"}, 1_us, 60_s);
    if (!delay && !section.describes()) {
      section.missing("delay", "it says how long frames are held back, e.g. \"5ms\"");
    }
    event.fault.delay = delay.value_or(0_ns);
  }
  return event;
}

void EventSectionReader::read_set(TableReader& section, base::SimDuration at,
                                  std::vector<EventConfiguration>& events) {
  const DeviceAddress target = targets_.read_target(section);
  const std::optional<std::string> input =
      section.text({"input", "What is set, see stator describe DEVICE --inputs"});
  const std::optional<double> value =
      section.number({"value", "Its new value, which stays"}, -kAnyValue, kAnyValue);
  if (!section.describes() && (!input || !value)) {
    section.fail(input ? "value" : "input",
                 "\"set\" needs \"input\", which names what is set, and \"value\"; \"stator "
                 "describe DEVICE --inputs\" lists the inputs");
  }
  if (section.describes() || !section.problems().list.empty()) {
    // Inputs are not looked up, since a device whose table has errors may not exist.
    static_cast<void>(
        section.number({"from", "A ramp begins at this value"}, -kAnyValue, kAnyValue));
    static_cast<void>(section.duration({"over", "How long the ramp takes"}, kRampStep, 60_s));
    return;
  }
  if (const std::string problem = input_problem(targets_.inputs_of(target), *input, *value);
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
    if (const std::string problem = input_problem(targets_.inputs_of(target), *input, *from);
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

void EventSectionReader::read(TableReader& section, std::vector<EventConfiguration>& events) {
  const std::optional<base::SimDuration> at =
      section.duration({"at", "When, counted from the start of the rack"}, 0_ns, kLatest);
  if (!at) {
    section.refuse_missing("at", "it says when, e.g. \"5s\" after the rack's start");
    if (!section.describes()) {
      TableReader::abandon();
    }
  }
  const std::set<std::string> names(action_names().begin(), action_names().end());
  section.select({"action", "What happens"}, action_names(),
                 "it must be one of: " + settings::joined(names), [&](const std::string& action) {
                   read_action(section, action, at.value_or(0_ns), events);
                   section.finish();
                 });
}

void EventSectionReader::read_action(TableReader& section, const std::string& action,
                                     base::SimDuration at,
                                     std::vector<EventConfiguration>& events) {
  if (action == "set") {
    read_set(section, at, events);
  } else if (action == "break" || action == "heal") {
    events.push_back({at, read_cable(section, action == "heal")});
  } else if (action == "power-off" || action == "power-on") {
    events.push_back({at, PowerEvent{targets_.read_target(section), action == "power-on"}});
  } else if (action == "bus-off" || action == "error-passive") {
    const bool off = action == "bus-off";
    events.push_back(
        {at, ErrorStateEvent{targets_.read_can_target(section),
                             off ? can::ErrorState::bus_off : can::ErrorState::error_passive}});
  } else {
    events.push_back({at, read_frame_fault(section, action)});
  }
}

}  // namespace stator::rack
