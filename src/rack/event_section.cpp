#include "rack/event_section.hpp"

#include <set>
#include <string>

#include <fmt/format.h>

#include "rack/input_names.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/text.hpp"
#include "rack/wiring.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr base::SimDuration kLatest(std::int64_t{1'000'000'000} * 86'400 * 365);

constexpr double kAnyValue = 1e12;  // the input's own range decides
/// Simulated time between two steps of a ramp.
constexpr base::SimDuration kRampStep = 1_ms;

}  // namespace

DeviceAddress EventSectionReader::read_target(TomlSection& section) const {
  const std::optional<std::string> name = section.text("device");
  if (!name) {
    section.fail("device", "\"device\" is missing; it names the device to which this happens");
  }
  std::set<std::string> names;
  for (std::size_t s = 0; s < segments_.size(); ++s) {
    for (std::size_t d = 0; d < segments_[s].devices.size(); ++d) {
      if (segments_[s].devices[d].name == *name) {
        return {s, d};
      }
      names.insert(segments_[s].devices[d].name);
    }
  }
  const std::string guess = closest_match(*name, names);
  section.fail("device",
               fmt::format("\"device\" is \"{}\"{}; the devices are: {}", *name,
                           guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                           fmt::join(names, ", ")));
}

RackEvent EventSectionReader::read_cable(TomlSection& section, bool intact) const {
  const DeviceAddress target = read_target(section);
  const SegmentConfiguration& segment = segments_[target.segment];
  const DeviceConfiguration& device = segment.devices[target.device];
  CableEvent event{target, device.wiring.entry_port, intact};
  if (const auto port = section.integer("port", 0, 3)) {
    event.port = static_cast<unsigned>(*port);
  }
  if (!has_cable(segment, target.device, event.port)) {
    section.fail("port", fmt::format("port {} of \"{}\" has no cable", event.port, device.name));
  }
  return event;
}

const EventSectionReader::Inputs& EventSectionReader::inputs_of(DeviceAddress device) {
  const auto [place, is_new] = inputs_.try_emplace({device.segment, device.device});
  if (is_new) {
    place->second =
        make_device(segments_[device.segment].devices[device.device].product, {})->inputs();
  }
  return place->second;
}

void EventSectionReader::read_set(TomlSection& section, base::SimDuration at,
                                  std::vector<EventConfiguration>& events) {
  const DeviceAddress target = read_target(section);
  const std::optional<std::string> input = section.text("input");
  const std::optional<double> value = section.number("value", -kAnyValue, kAnyValue);
  if (!input || !value) {
    section.fail(input ? "value" : "input",
                 "\"set\" needs \"input\", which names what is set, and \"value\"; \"stator "
                 "describe DEVICE --inputs\" lists the inputs");
  }
  if (const std::string problem = input_problem(inputs_of(target), *input, *value);
      !problem.empty()) {
    section.fail("value", problem);
  }
  const std::optional<double> from = section.number("from", -kAnyValue, kAnyValue);
  const std::optional<base::SimDuration> over = section.duration("over", kRampStep, 60_s);
  if (from.has_value() != over.has_value()) {
    section.fail(from ? "from" : "over",
                 "a ramp needs both: \"from\", the value it starts at, and \"over\", how long it "
                 "takes");
  }
  if (over) {
    if (const std::string problem = input_problem(inputs_of(target), *input, *from);
        !problem.empty()) {
      section.fail("from", problem);
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
  const std::optional<base::SimDuration> at = section.duration("at", 0_ns, kLatest);
  if (!at) {
    section.fail("at", "\"at\" is missing; it says when, e.g. \"5s\" after the rack's start");
  }
  const auto action = section.choice("action", {"break", "heal", "power-off", "power-on", "set"});
  if (!action) {
    section.fail("action",
                 "\"action\" is missing; it must be one of: break, heal, power-off, power-on, set");
  }
  if (*action == "set") {
    read_set(section, *at, events);
  } else if (*action == "break" || *action == "heal") {
    events.push_back({*at, read_cable(section, *action == "heal")});
  } else {
    events.push_back({*at, PowerEvent{read_target(section), *action == "power-on"}});
  }
  section.finish();
}

}  // namespace stator::rack
