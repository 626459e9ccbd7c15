#include "stator/rack/file/wiring_section.hpp"

#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

// 100 m of copper delay a frame by half a microsecond; fibre converters by more.
constexpr base::SimDuration kLongestDelay = 1_ms;

std::size_t read_after(TableReader& section, const std::string& name,
                       std::span<const DeviceConfiguration> before) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].name == name) {
      return i;
    }
    names.insert(before[i].name);
  }
  const std::string guess = settings::closest_match(name, names);
  section.fail_for_reference(
      "after",
      fmt::format("\"after\" is \"{}\"{}; it must name a device above this one in the same "
                  "segment: {}",
                  name, guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                  names.empty() ? "there is none" : fmt::format("{}", fmt::join(names, ", "))));
}

void require_port(TableReader& section, const char* key, unsigned port,
                  const DeviceConfiguration& device) {
  const unsigned ports = device.setup.product().ports(device.setup);
  if (port >= ports) {
    section.fail(key, fmt::format(R"("{}" is {}, but "{}" has the ports 0 to {})", key, port,
                                  device.name, ports - 1));
  }
}

/// What is wrong with the port of the device this one hangs at.
void require_free_port(TableReader& section, std::span<const DeviceConfiguration> before,
                       const Attachment& attachment) {
  const DeviceConfiguration& parent = before[*attachment.parent];
  require_port(section, "port", attachment.parent_port, parent);
  if (attachment.parent_port == parent.wiring.entry_port) {
    section.fail("port",
                 fmt::format(R"(port {} of "{}" leads to the master; choose another "port")",
                             attachment.parent_port, parent.name));
  }
  if (const auto other = device_at(before, *attachment.parent, attachment.parent_port)) {
    section.fail("port", fmt::format("\"{}\" hangs at port {} of \"{}\" already; choose another "
                                     "\"port\" or \"after\"",
                                     before[*other].name, attachment.parent_port, parent.name));
  }
}

}  // namespace

void read_wiring(TableReader& section, std::span<DeviceConfiguration> devices) {
  DeviceConfiguration& device = devices.back();
  const std::span<const DeviceConfiguration> before = devices.first(devices.size() - 1);
  WiringConfiguration& wiring = device.wiring;
  // All keys are read before one can end the reading, so that none is called unknown.
  const auto after = section.text({"after",
                                   "Name of the device it hangs at, one above it in the same "
                                   "segment; by default the one above"});
  const auto port = section.integer(
      {"port", "Port of that device; by default the one away from the master"}, 0, 3);
  section.note_default("entry_port", "0");
  const auto entry_port =
      section.integer({"entry_port", "Port of this device towards the master"}, 0, 3);
  section.duration({"cable_delay", "Of the cable in front of it, one way"}, 0_ns, kLongestDelay,
                   wiring.cable_delay);
  device.forwarding_delay = section.duration(
      {"forwarding_delay", "Of its slave controller, from port to port"}, 40_ns, kLongestDelay);
  if (after) {
    wiring.after = read_after(section, *after, before);
  }
  if (port) {
    wiring.port = static_cast<unsigned>(*port);
    if (before.empty()) {
      section.refuse(
          "port",
          "the first device hangs at the master and needs no \"port\"; its own end of the "
          "cable is \"entry_port\"");
    }
  }
  if (entry_port) {
    wiring.entry_port = static_cast<unsigned>(*entry_port);
    require_port(section, "entry_port", wiring.entry_port, device);
  }
  if (!before.empty()) {
    require_free_port(section, before, attachment_of(devices, before.size()));
  }
}

}  // namespace stator::rack
