// What the rack offers for single devices, beside their networks.
#include <algorithm>
#include <array>

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

std::vector<DeviceAddress> Rack::addresses() const {
  std::vector<DeviceAddress> all;
  for (std::size_t network = 0; network < segments_.size(); ++network) {
    for (std::size_t i = 0; i < segments_[network].devices.size(); ++i) {
      all.push_back({network, i, NetworkKind::segment});
    }
  }
  for (std::size_t network = 0; network < buses_.size(); ++network) {
    for (std::size_t i = 0; i < buses_[network].inputs.size(); ++i) {
      all.push_back({network, i, NetworkKind::bus});
    }
  }
  return all;
}

const std::string& Rack::name_of(DeviceAddress device) {
  return device.kind == NetworkKind::bus ? bus(device.network).devices()[device.device].name
                                         : segments_[device.network].devices[device.device].name;
}

product::Device& Rack::device(DeviceAddress device) {
  if (device.kind == NetworkKind::bus) {
    return *bus(device.network).devices()[device.device].device;
  }
  return *segments_[device.network].devices[device.device].device;
}

const std::vector<product::Input>& Rack::inputs(DeviceAddress device) const {
  return (device.kind == NetworkKind::bus ? buses_[device.network].inputs
                                          : segments_[device.network].inputs)[device.device];
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
  segments_[device.network].devices[device.device].device->controller().peek(kAlStatus, status);
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
  report(number_of(address), now, text ? kTextSet : kObjectSet,
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

void Rack::add(SignalTap& tap, base::SimTime now) {
  tap.begin(now);
  taps_.push_back(&tap);
}

void Rack::remove(const SignalTap& tap) {
  std::erase(taps_, &tap);
}

void Rack::watch_traffic(TrafficTap* tap) {
  traffic_ = tap;
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    buses_[i].network->watch_traffic(tap, static_cast<std::uint16_t>(segments_.size() + i));
  }
}

base::SimTime Rack::next_tap() const {
  base::SimTime next = base::SimTime::never();
  for (const SignalTap* tap : taps_) {
    next = std::min(next, tap->next_sample());
  }
  return next;
}

void Rack::sample_taps(base::SimTime now) {
  for (SignalTap* tap : taps_) {
    if (tap->next_sample() <= now) {
      tap->sample(now);
    }
  }
}

}  // namespace stator::rack
