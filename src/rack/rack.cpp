#include "rack/rack.hpp"

#include <utility>

#include "rack/product_catalogue.hpp"

namespace stator::rack {

Rack::Rack(const RackConfiguration& configuration, EventLog& log) {
  std::vector<std::string> names;
  if (!configuration.state.empty()) {
    storage_ = std::make_unique<DeviceStorage>(configuration.state);
  }
  for (const SegmentConfiguration& segment : configuration.segments) {
    SegmentMembers members;
    members.segment = std::make_unique<ethercat::Segment>();
    for (const DeviceConfiguration& device : segment.devices) {
      const base::EventReporter reporter(&log, static_cast<std::uint16_t>(names.size()));
      names.push_back(device.name);
      log.set_device_names(names);
      members.devices.push_back({device.name, make_device(device.product, reporter)});
      if (storage_ != nullptr) {
        storage_->attach(device.name, *members.devices.back().device, reporter);
      }
      members.segment->append(members.devices.back().device->controller());
    }
    segments_.push_back(std::move(members));
  }
  if (configuration.record) {
    recorder_.emplace(configuration.record->file,
                      select_signals(signals(), configuration.record->signals),
                      configuration.record->period);
  }
}

bool Rack::process_frame(std::size_t segment, std::span<std::byte> frame, base::SimTime arrival) {
  return segments_[segment].segment->process(frame, arrival);
}

void Rack::handle_bus_events(std::size_t segment, base::SimTime now) {
  for (NamedDevice& member : segments_[segment].devices) {
    member.device->handle_bus_events(now);
  }
}

void Rack::advance(base::SimTime now) {
  while (recorder_ && recorder_->next_sample() <= now) {
    const base::SimTime instant = recorder_->next_sample();
    advance_devices(instant);
    recorder_->sample(instant);
  }
  advance_devices(now);
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
