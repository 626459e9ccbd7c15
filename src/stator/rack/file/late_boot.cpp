#include "stator/rack/file/late_boot.hpp"

#include <utility>
#include <variant>
#include <vector>

#include "stator/dictionary/quirks.hpp"

namespace stator::rack {

namespace {

base::SimDuration late_boot_of(const DeviceConfiguration& device) {
  const dictionary::Quirks* const quirks = device.setup.quirks();
  return quirks != nullptr ? quirks->late_boot : base::SimDuration();
}

void delay(DeviceAddress device, base::SimDuration time, std::vector<EventConfiguration>& events) {
  for (EventConfiguration& event : events) {
    const auto* power = std::get_if<PowerEvent>(&event.event);
    if (power != nullptr && power->device == device && power->on) {
      event.at += time;
    }
  }
  events.push_back({base::SimDuration(), PowerEvent{device, false}});
  events.push_back({time, PowerEvent{device, true}});
}

}  // namespace

void apply_late_boot(RackConfiguration& configuration) {
  const auto look = [&](const std::vector<DeviceConfiguration>& devices, std::size_t network,
                        NetworkKind kind) {
    for (std::size_t i = 0; i < devices.size(); ++i) {
      if (const base::SimDuration time = late_boot_of(devices[i]); time > base::SimDuration()) {
        delay({network, i, kind}, time, configuration.events);
      }
    }
  };
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    look(configuration.segments[i].devices, i, NetworkKind::segment);
  }
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    look(configuration.buses[i].devices, i, NetworkKind::bus);
  }
}

}  // namespace stator::rack
