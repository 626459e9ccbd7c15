#include "rack/event_section.hpp"

#include <set>
#include <string>

#include <fmt/format.h>

#include "rack/text.hpp"
#include "rack/wiring.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr base::SimDuration kLatest(std::int64_t{1'000'000'000} * 86'400 * 365);

DeviceAddress read_target(TomlSection& section, std::span<const SegmentConfiguration> segments) {
  const std::optional<std::string> name = section.text("device");
  if (!name) {
    section.fail("device", "\"device\" is missing; it names the device to which this happens");
  }
  std::set<std::string> names;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (std::size_t d = 0; d < segments[s].devices.size(); ++d) {
      if (segments[s].devices[d].name == *name) {
        return {s, d};
      }
      names.insert(segments[s].devices[d].name);
    }
  }
  const std::string guess = closest_match(*name, names);
  section.fail("device",
               fmt::format("\"device\" is \"{}\"{}; the devices are: {}", *name,
                           guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                           fmt::join(names, ", ")));
}

RackEvent read_cable(TomlSection& section, std::span<const SegmentConfiguration> segments,
                     bool intact) {
  const DeviceAddress target = read_target(section, segments);
  const SegmentConfiguration& segment = segments[target.segment];
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

}  // namespace

EventConfiguration read_event(TomlSection& section,
                              std::span<const SegmentConfiguration> segments) {
  const std::optional<base::SimDuration> at = section.duration("at", 0_ns, kLatest);
  if (!at) {
    section.fail("at", "\"at\" is missing; it says when, e.g. \"5s\" after the rack's start");
  }
  const auto action = section.choice("action", {"break", "heal", "power-off", "power-on"});
  if (!action) {
    section.fail("action",
                 "\"action\" is missing; it must be one of: break, heal, power-off, power-on");
  }
  EventConfiguration event{*at, {}};
  if (*action == "break" || *action == "heal") {
    event.event = read_cable(section, segments, *action == "heal");
  } else {
    event.event = PowerEvent{read_target(section, segments), *action == "power-on"};
  }
  section.finish();
  return event;
}

}  // namespace stator::rack
