// The read-only side of a rack: devices, signals, inputs, faults and deadlines.
#include "stator/rack/core/view.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "stator/rack/core/internal/rack_parts.hpp"

namespace stator::rack {

namespace {

constexpr std::uint16_t kAlStatus = 0x0130;
constexpr unsigned kAlStateMask = 0x0F;

}  // namespace

View::View(std::unique_ptr<RackParts> parts) : parts_(std::move(parts)) {}

View::~View() = default;

std::size_t View::segment_count() const {
  return parts_->segments.size();
}

const ethercat::Segment& View::segment(std::size_t index) const {
  return *parts_->segments[index].segment;
}

std::size_t View::bus_count() const {
  return parts_->buses.size();
}

const CanNetwork& View::bus(std::size_t index) const {
  return *parts_->buses[index].network;
}

std::size_t View::line_count() const {
  return parts_->lines.size();
}

const SerialLine& View::line(std::size_t index) const {
  return parts_->lines[index];
}

std::uint16_t View::number_of(DeviceAddress device) const {
  return parts_->number_of(device);
}

const Recorder* View::recorder() const {
  return parts_->recorder ? &*parts_->recorder : nullptr;
}

const OutputFiles& View::outputs() const {
  return parts_->outputs;
}

std::vector<DeviceAddress> View::addresses() const {
  std::vector<DeviceAddress> all;
  for (std::size_t network = 0; network < parts_->segments.size(); ++network) {
    for (std::size_t i = 0; i < parts_->segments[network].devices.size(); ++i) {
      all.push_back({network, i, NetworkKind::segment});
    }
  }
  for (std::size_t network = 0; network < parts_->buses.size(); ++network) {
    for (std::size_t i = 0; i < parts_->buses[network].inputs.size(); ++i) {
      all.push_back({network, i, NetworkKind::bus});
    }
  }
  return all;
}

const std::string& View::name_of(DeviceAddress device) const {
  return device.kind == NetworkKind::bus
             ? parts_->buses[device.network].network->devices()[device.device].name
             : parts_->segments[device.network].devices[device.device].name;
}

const product::Device& View::device(DeviceAddress device) const {
  return parts_->device(device);
}

const product::EtherCatDevice& View::slave(DeviceAddress device) const {
  return *parts_->segments[device.network].devices[device.device].device;
}

const product::CanDevice& View::node(DeviceAddress device) const {
  return *parts_->buses[device.network].network->devices()[device.device].device;
}

const std::vector<product::InputRange>& View::inputs(DeviceAddress device) const {
  return (device.kind == NetworkKind::bus ? parts_->buses[device.network].ranges
                                          : parts_->segments[device.network].ranges)[device.device];
}

std::optional<double> View::input_value(const std::pair<DeviceAddress, std::string>& input) const {
  const auto known = parts_->held_inputs.find(input);
  return known == parts_->held_inputs.end() ? std::nullopt : std::optional(known->second.value());
}

bool View::powered(DeviceAddress device) const {
  return device.kind == NetworkKind::bus ? bus(device.network).powered(device.device)
                                         : segment(device.network).powered(device.device);
}

dictionary::NetworkState View::network_state(DeviceAddress device) const {
  using dictionary::NetworkState;
  if (device.kind == NetworkKind::bus) {
    return node(device).network_state();
  }
  std::array<std::byte, 1> status{};
  slave(device).controller().peek(kAlStatus, status);
  switch (std::to_integer<unsigned>(status[0]) & kAlStateMask) {
    case 8:
      return NetworkState::operational;
    case 4:
      return NetworkState::safe_operational;
    default:
      return NetworkState::pre_operational;
  }
}

std::vector<FaultStatus> View::faults(base::SimTime now) const {
  return parts_->faults->list(now);
}

base::SimTime View::next_bus_deadline() const {
  base::SimTime next = std::min(parts_->timetable.next(), parts_->faults->next());
  for (const RackParts::BusMembers& members : parts_->buses) {
    next = std::min(next, members.network->next_deadline());
  }
  return next;
}

base::SimTime View::next_line_deadline(std::size_t line) const {
  return std::min({parts_->timetable.next(), parts_->faults->next(),
                   parts_->lines[line].next_deadline(),
                   parts_->lines[line].next_device_deadline()});
}

std::vector<product::Signal> View::signals() const {
  std::vector<product::Signal> all;
  const auto add = [&all](const std::string& device, const product::Device& from) {
    for (product::Signal signal : from.signals()) {
      signal.name = device + "." + signal.name;
      all.push_back(std::move(signal));
    }
  };
  for (const RackParts::SegmentMembers& members : parts_->segments) {
    for (const NamedDevice& member : members.devices) {
      add(member.name, *member.device);
    }
  }
  for (const RackParts::BusMembers& members : parts_->buses) {
    for (const NamedCanDevice& member : members.network->devices()) {
      add(member.name, *member.device);
    }
    if (members.wire) {
      std::ranges::move(members.network->signals(), std::back_inserter(all));
    }
  }
  return all;
}

}  // namespace stator::rack
