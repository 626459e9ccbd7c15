#include "stator/rack/file/target_reader.hpp"

#include <set>

#include <fmt/format.h>

#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

DeviceAddress TargetReader::read_target(TableReader& section) const {
  const std::optional<std::string> name =
      section.text({"device",
                    "Name of the device; of drop and the like: only frames this device sends, on "
                    "EtherCAT those that pass its port"});
  if (section.describes()) {
    return {};
  }
  return find_device(section, name);
}

DeviceAddress TargetReader::find_device(TableReader& section,
                                        const std::optional<std::string>& name) const {
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
  const std::string guess = settings::closest_match(*name, names);
  section.fail_for_reference(
      "device", fmt::format(R"("device" is "{}"{}; the devices are: {})", *name,
                            guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                            fmt::join(names, ", ")));
}

const DeviceConfiguration& TargetReader::device_at(DeviceAddress address) const {
  return address.kind == NetworkKind::bus ? rack_.buses[address.network].devices[address.device]
                                          : rack_.segments[address.network].devices[address.device];
}

void TargetReader::require_can(TableReader& section, DeviceAddress target) const {
  if (section.describes()) {
    return;
  }
  if (target.kind != NetworkKind::bus || !rack_.buses[target.network].wire) {
    section.fail("device", fmt::format("\"{}\" is on no CAN bus, so this cannot happen to it",
                                       device_at(target).name));
  }
}

DeviceAddress TargetReader::read_can_target(TableReader& section) const {
  const DeviceAddress target = read_target(section);
  require_can(section, target);
  return target;
}

/// A port of an EtherCAT device with a cable, by default the one it is reached through.
unsigned TargetReader::read_port(TableReader& section, DeviceAddress target) const {
  const auto given =
      section.integer({"port", "Port at which the cable ends; by default entry_port"}, 0, 3);
  if (section.describes()) {
    return 0;
  }
  const SegmentConfiguration& segment = rack_.segments[target.network];
  const DeviceConfiguration& device = segment.devices[target.device];
  const unsigned port = given ? static_cast<unsigned>(*given) : device.wiring.entry_port;
  if (!has_cable(segment, target.device, port)) {
    section.refuse("port", fmt::format("port {} of \"{}\" has no cable", port, device.name));
  }
  return port;
}

std::size_t TargetReader::read_bus(TableReader& section, const std::string& name) const {
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
               fmt::format(R"("bus" is "{}"; the buses are: {})", name,
                           names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

const std::vector<product::InputRange>& TargetReader::inputs_of(DeviceAddress device) {
  const auto [place, is_new] = inputs_.try_emplace(device);
  if (is_new) {
    const std::vector<product::Input> inputs = device_at(device).setup.make()->inputs();
    place->second.assign(inputs.begin(), inputs.end());
  }
  return place->second;
}

}  // namespace stator::rack
