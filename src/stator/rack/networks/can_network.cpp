#include "stator/rack/networks/can_network.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr std::size_t kNoDevice = std::numeric_limits<std::size_t>::max();
/// A device that has a deadline in the past for ever must not stop time.
constexpr base::SimDuration kShortestWait = 1_us;

}  // namespace

CanNetwork::CanNetwork(const BusConfiguration& configuration)
    : name_(configuration.name),
      tap_(configuration.log, configuration.capture, configuration.name),
      bus_({.bit_rate = configuration.bit_rate,
            .ports_acknowledge = configuration.ports_acknowledge}) {
  look_at_wire();
}

void CanNetwork::watch_traffic(TrafficTap* tap, std::uint16_t network) {
  tap_.watch(tap, network);
  look_at_wire();
}

void CanNetwork::observe(base::Delegate<void(const can::TraceEntry&)> observer) {
  observer_ = observer;
  look_at_wire();
}

// The bus calls trace() only while there is a file to write or somebody who watches.
void CanNetwork::look_at_wire() {
  using Trace = base::Delegate<void(const can::TraceEntry&)>;
  bus_.set_trace(observer_ || !tap_.empty() ? Trace::bind<&CanNetwork::trace>(*this) : Trace());
}

void CanNetwork::trace(const can::TraceEntry& entry) {
  if (!tap_.empty()) {
    tap_.write(entry);
  }
  if (observer_) {
    observer_(entry);
  }
}

void CanNetwork::add(NamedCanDevice device, const base::EventReporter& reporter) {
  devices_.push_back(std::move(device));
  product::CanDevice& added = *devices_.back().device;
  const std::size_t member = bus_.add(
      added.controller(),
      {.bit_rate = added.bit_rate(), .recovery = added.bus_off_recovery(), .reporter = reporter});
  members_.push_back(member);
  device_of_.resize(member + 1, kNoDevice);
  device_of_[member] = devices_.size() - 1;
  deadlines_.push_back(base::SimTime::never());
  refresh(devices_.size() - 1, {});
}

void CanNetwork::advance(base::SimTime now) {
  do {
    for (base::SimTime moment = next_deadline(); moment <= now; moment = next_deadline()) {
      now_ = std::max(now_, moment);
      for (std::size_t i = 0; earliest_ <= now_ && i < devices_.size(); ++i) {
        if (deadlines_[i] <= now_) {
          devices_[i].device->advance(now_);
          refresh(i, now_);
        }
      }
      bus_.advance(now_);
      serve_reached();
      find_earliest();
    }
    now_ = std::max(now_, now);
    for (NamedCanDevice& member : devices_) {
      member.device->advance(now_);
    }
    bus_.advance(now_);
    serve_reached();
    find_earliest();
  } while (next_deadline() <= now);
}

void CanNetwork::serve_reached() {
  bus_.take_reached([this](std::size_t member) { serve(device_of_[member], now_); });
}

void CanNetwork::serve(std::size_t device, base::SimTime now) {
  devices_[device].device->advance(now);
  devices_[device].device->handle_bus_events(now);
  refresh(device, now);
}

void CanNetwork::refresh(std::size_t device, base::SimTime now) {
  const product::CanDevice& refreshed = *devices_[device].device;
  bus_.set_bit_rate(members_[device], refreshed.bit_rate());
  base::SimTime& deadline = deadlines_[device];
  earliest_stale_ |= deadline == earliest_;
  deadline = std::max(refreshed.next_deadline(), now + kShortestWait);
  earliest_ = std::min(earliest_, deadline);
}

void CanNetwork::find_earliest() {
  if (!earliest_stale_) {
    return;
  }
  earliest_stale_ = false;
  earliest_ = base::SimTime::never();
  for (const base::SimTime deadline : deadlines_) {
    earliest_ = std::min(earliest_, deadline);
  }
}

void CanNetwork::set_connected(std::size_t device, bool connected) {
  bus_.set_connected(members_[device], connected);
}

void CanNetwork::set_power(std::size_t device, bool on, base::SimTime now) {
  bus_.set_power(members_[device], on);
  devices_[device].device->set_power(on, now);
  refresh(device, now);
}

void CanNetwork::set_error_state(std::size_t device, can::ErrorState state, base::SimTime now) {
  if (state == can::ErrorState::bus_off) {
    bus_.force_bus_off(members_[device], now);
  } else {
    bus_.force_error_passive(members_[device], now);
  }
  serve_reached();
}

std::uint64_t CanNetwork::inject(const FrameFaultEvent& event) {
  can::FrameFault fault = event.fault;
  if (event.device) {
    fault.sender = members_[*event.device];
  }
  return bus_.inject(fault);
}

std::vector<product::Signal> CanNetwork::signals() const {
  using Read = base::SignalReader;
  return {{name_ + ".load", "1", Read::bind<&CanNetwork::load>(*this)},
          {name_ + ".frames", "1", Read::bind<&CanNetwork::frames>(*this)},
          {name_ + ".error_frames", "1", Read::bind<&CanNetwork::error_frames>(*this)}};
}

}  // namespace stator::rack
