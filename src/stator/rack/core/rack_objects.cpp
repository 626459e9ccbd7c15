// What the rack has: networks, devices and their objects, files, who watches.
#include <algorithm>
#include <array>

#include "stator/rack/core/internal/rack_parts.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/journal.hpp"

namespace stator::rack {

namespace {

constexpr std::uint16_t kAlStatus = 0x0130;
constexpr unsigned kAlStateMask = 0x0F;

constexpr base::EventRule kObjectSet{"object-set", base::Severity::information,
                                     "object {0:x4}:{1:x2} \"{2}\" is set to {3} from outside"};
constexpr base::EventRule kTextSet{"object-set", base::Severity::information,
                                   "object {0:x4}:{1:x2} \"{2}\" is set from outside"};

}  // namespace

std::size_t Rack::segment_count() const {
  return parts_->segments.size();
}

const ethercat::Segment& Rack::segment(std::size_t index) const {
  return *parts_->segments[index].segment;
}

ethercat::Segment& Rack::segment(std::size_t index) {
  return *parts_->segments[index].segment;
}

std::span<NamedDevice> Rack::devices(std::size_t segment) {
  return parts_->segments[segment].devices;
}

std::size_t Rack::bus_count() const {
  return parts_->buses.size();
}

CanNetwork& Rack::bus(std::size_t index) {
  return *parts_->buses[index].network;
}

const CanNetwork& Rack::bus(std::size_t index) const {
  return *parts_->buses[index].network;
}

std::size_t Rack::line_count() const {
  return parts_->lines.size();
}

SerialLine& Rack::line(std::size_t index) {
  return parts_->lines[index];
}

const SerialLine& Rack::line(std::size_t index) const {
  return parts_->lines[index];
}

std::uint16_t Rack::number_of(DeviceAddress device) const {
  return parts_->number_of(device);
}

base::EventReporter Rack::reporter(DeviceAddress device) {
  return base::EventReporter(&parts_->log, number_of(device));
}

base::EventReporter Rack::bus_reporter(std::size_t index) {
  return base::EventReporter(&parts_->log, parts_->buses[index].number);
}

const Recorder* Rack::recorder() const {
  return parts_->recorder ? &*parts_->recorder : nullptr;
}

PinTrace* Rack::trace() {
  return parts_->trace.get();
}

DeviceStorage* Rack::storage() {
  return parts_->storage.get();
}

void Rack::settle_log(base::SimTime now) {
  parts_->log.settle(now);
}

OutputFiles& Rack::outputs() {
  return parts_->outputs;
}

const OutputFiles& Rack::outputs() const {
  return parts_->outputs;
}

std::vector<DeviceAddress> Rack::addresses() const {
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

const std::string& Rack::name_of(DeviceAddress device) {
  return device.kind == NetworkKind::bus
             ? bus(device.network).devices()[device.device].name
             : parts_->segments[device.network].devices[device.device].name;
}

product::Device& Rack::device(DeviceAddress device) {
  if (device.kind == NetworkKind::bus) {
    return *bus(device.network).devices()[device.device].device;
  }
  return *parts_->segments[device.network].devices[device.device].device;
}

const std::vector<product::Input>& Rack::inputs(DeviceAddress device) const {
  return (device.kind == NetworkKind::bus ? parts_->buses[device.network].inputs
                                          : parts_->segments[device.network].inputs)[device.device];
}

bool Rack::powered(DeviceAddress device) const {
  return device.kind == NetworkKind::bus ? bus(device.network).powered(device.device)
                                         : segment(device.network).powered(device.device);
}

dictionary::NetworkState Rack::network_state(DeviceAddress device) {
  using dictionary::NetworkState;
  if (device.kind == NetworkKind::bus) {
    return bus(device.network).devices()[device.device].device->network_state();
  }
  std::array<std::byte, 1> status{};
  parts_->segments[device.network].devices[device.device].device->controller().peek(kAlStatus,
                                                                                    status);
  switch (std::to_integer<unsigned>(status[0]) & kAlStateMask) {
    case 8:
      return NetworkState::operational;
    case 4:
      return NetworkState::safe_operational;
    default:
      return NetworkState::pre_operational;
  }
}

dictionary::Verdict Rack::read_object(DeviceAddress address, dictionary::Entry& entry,
                                      std::vector<std::byte>& value) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->object_read(address, entry.index(), entry.subindex());
  }
  const dictionary::Dictionary& objects = *device(address).object_dictionary();
  if (dictionary::Verdict verdict = objects.prepare_read(entry); !verdict) {
    return verdict;
  }
  value.resize(entry.size());
  return objects.read(entry, value);
}

dictionary::Verdict Rack::write_object(DeviceAddress address, dictionary::Entry& entry,
                                       std::span<const std::byte> value, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->object_written(address, entry.index(), entry.subindex(), value, now);
  }
  product::Device& written = device(address);
  const dictionary::Verdict verdict =
      written.object_dictionary()->write(entry, value, {network_state(address)});
  if (!verdict) {
    return verdict;
  }
  const bool text = dictionary::is_string(entry.type());
  parts_->report(parts_->number_of(address), now, text ? kTextSet : kObjectSet,
                 {entry.index(), std::size_t{entry.subindex()}, entry.shared_name(),
                  text ? base::EventArgument() : base::EventArgument(entry.signed_value())});
  // The first question belongs to the write: from it on what is ordered takes its time.
  if (dictionary::WriteCompletion* completion = written.write_completion()) {
    static_cast<void>(completion->poll(entry, now));
  }
  written.objects_written(now);
  if (address.kind == NetworkKind::bus) {
    bus(address.network).touched(address.device);
  }
  return verdict;
}

std::optional<dictionary::Verdict> Rack::completion_of_write(DeviceAddress address,
                                                             const dictionary::Entry& entry,
                                                             base::SimTime now) {
  dictionary::WriteCompletion* completion = device(address).write_completion();
  return completion == nullptr ? dictionary::Verdict() : completion->poll(entry, now);
}

void Rack::set_journal(Journal* journal) {
  parts_->journal = journal;
  parts_->lines.set_journal(journal);
}

Journal* Rack::journal() {
  return parts_->journal;
}

void Rack::add(SignalTap& tap, base::SimTime now) {
  tap.begin(now);
  parts_->taps.push_back(&tap);
}

void Rack::remove(const SignalTap& tap) {
  std::erase(parts_->taps, &tap);
}

void Rack::watch_traffic(TrafficTap* tap) {
  parts_->traffic = tap;
  for (std::size_t i = 0; i < parts_->buses.size(); ++i) {
    parts_->buses[i].network->watch_traffic(
        tap, static_cast<std::uint16_t>(parts_->segments.size() + i));
  }
}

}  // namespace stator::rack
