#include "stator/scenario/step_reader.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/device/device.hpp"

namespace stator::scenario {

namespace {

using settings::custom;
using settings::Section;
using settings::text;

constexpr std::array kDeviceRows{
    text<&Target::device_name>("device", "Name of the device; a rack with one needs none")};
constexpr Section<Target> kDeviceKeys{kDeviceRows};

constexpr std::array kAnyDeviceRows{
    text<&Target::device_name>("device", "Name of the device; without it all")};
constexpr Section<Target> kAnyDeviceKeys{kAnyDeviceRows};

void read_segment(const settings::KeyWords& key, settings::Reader& reader, Target& on) {
  reader.integer(key, 0, static_cast<std::int64_t>(on.last_segment), on.network);
}
constexpr std::array kSegmentRows{
    custom<Target, read_segment>("segment", "EtherCAT segment, counted from 0")};
constexpr Section<Target> kSegmentKeys{kSegmentRows};

constexpr std::array kBusRows{
    text<&Target::bus_name>("bus", "Name of the CAN bus; the first one without it")};
constexpr Section<Target> kBusKeys{kBusRows};

/// Of a rack that has no other.
std::optional<rack::DeviceAddress> only_device(const rack::RackConfiguration& rack) {
  std::size_t devices = 0;
  rack::DeviceAddress last;
  const auto count = [&](const auto& networks, rack::NetworkKind kind) {
    for (std::size_t i = 0; i < networks.size(); ++i) {
      devices += networks[i].devices.size();
      last = networks[i].devices.empty() ? last : rack::DeviceAddress{i, 0, kind};
    }
  };
  count(rack.segments, rack::NetworkKind::segment);
  count(rack.buses, rack::NetworkKind::bus);
  return devices == 1 ? std::optional(last) : std::nullopt;
}

}  // namespace

std::vector<std::string> StepReader::product_types() const {
  std::vector<std::string> types;
  const auto add = [&types](const auto& networks) {
    for (const auto& network : networks) {
      for (const rack::DeviceConfiguration& device : network.devices) {
        types.push_back(device.setup.product().identity().type);
      }
    }
  };
  add(rack_.segments);
  add(rack_.buses);
  return types;
}

void StepReader::device(rack::TableReader& section, Target& on) const {
  on.device = only_device(rack_);
  if (on.device && !section.contains("device")) {
    return;
  }
  settings::read_keys(kDeviceKeys, section, on);
  if (!section.describes()) {
    on.device = targets_.find_device(section, on.device_name);
  }
}

void StepReader::slave(rack::TableReader& section, Target& on) const {
  device(section, on);
  if (on.device && on.device->kind != rack::NetworkKind::segment) {
    section.fail("device",
                 fmt::format("\"{}\" has no EtherCAT slave controller", name_of(*on.device)));
  }
}

void StepReader::any_device(rack::TableReader& section, Target& on) const {
  settings::read_keys(kAnyDeviceKeys, section, on);
  if (section.contains("device")) {
    on.device = targets_.find_device(section, on.device_name);
    on.network = on.device->network;
  }
}

void StepReader::segment(rack::TableReader& section, Target& on) const {
  if (!section.describes()) {
    if (rack_.segments.empty()) {
      section.fail("do", "the rack has no EtherCAT segment");
    }
    on.last_segment = rack_.segments.size() - 1;
  }
  settings::read_keys(kSegmentKeys, section, on);
}

void StepReader::bus(rack::TableReader& section, Target& on) const {
  settings::read_keys(kBusKeys, section, on);
  if (section.describes()) {
    return;
  }
  if (on.bus_name) {
    on.network = targets_.read_bus(section, *on.bus_name);
    return;
  }
  const auto wired = std::ranges::find_if(
      rack_.buses, [](const rack::BusConfiguration& bus) { return static_cast<bool>(bus.wire); });
  if (wired == rack_.buses.end()) {
    section.fail("do", "the rack has no CAN bus");
  }
  on.network = static_cast<std::size_t>(wired - rack_.buses.begin());
}

void StepReader::slaves(rack::TableReader& section, Target& on) const {
  any_device(section, on);
  if (!on.device) {
    segment(section, on);
  } else if (on.device->kind != rack::NetworkKind::segment) {
    section.fail("device", fmt::format("\"{}\" is on no EtherCAT segment; on a CAN bus it is "
                                       "\"nmt\" that changes states",
                                       name_of(*on.device)));
  }
}

void StepReader::nodes(rack::TableReader& section, Target& on) const {
  any_device(section, on);
  if (!on.device) {
    bus(section, on);
  }
}

const dictionary::Entry* find_entry(bench::Bench& bench, rack::DeviceAddress device,
                                    master::ObjectAddress object) {
  const dictionary::Dictionary* objects = bench.rack().device(device).object_dictionary();
  return objects != nullptr ? objects->find(object.index, object.subindex) : nullptr;
}

std::string axis_text(const std::string& device, unsigned axis) {
  return fmt::format("{} axis {}", device, axis);
}

std::string duration_text(base::SimDuration duration) {
  const double seconds = duration.seconds();
  return seconds < 1.0 ? fmt::format("{:g} ms", seconds * 1e3) : fmt::format("{:g} s", seconds);
}

}  // namespace stator::scenario
