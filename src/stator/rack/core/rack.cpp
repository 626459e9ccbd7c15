#include "stator/rack/core/rack.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "stator/rack/core/internal/coupling_ground.hpp"
#include "stator/rack/core/internal/fault_ground.hpp"
#include "stator/rack/core/internal/telling.hpp"
#include "stator/rack/core/nested_calls.hpp"
#include "stator/rack/world/wires.hpp"

namespace stator::rack {

namespace {

/// Lockstep: how far time moves on at most until a bus is idle. Longer than a frame and its answer
/// at the lowest bit rate, and an end to what would go on for ever.
constexpr base::SimDuration kLongestSettling{100'000'000};

/// The same for a serial line: longer than 4096 bytes at 9600 bit/s.
constexpr base::SimDuration kLongestReply{5'000'000'000};

/// Longer than a write and what answers it then.
constexpr base::SimDuration kLongestStoring{10'000'000};

constexpr base::EventRule kCarrierLost{
    "carrier-lost", base::Severity::warning,
    "the {0} network interface has no carrier: the other end is unplugged or switched off"};
constexpr base::EventRule kCarrierBack{"carrier-back", base::Severity::information,
                                       "the {0} network interface has a carrier"};

}  // namespace

Rack::Rack(const RackConfiguration& configuration, EventLog& log)
    : View(std::make_unique<RackParts>(configuration, log)) {
  std::vector<std::string> names;
  if (!configuration.state.empty()) {
    parts_->storage = std::make_unique<DeviceStorage>(configuration.state);
  }
  for (const SegmentConfiguration& segment : configuration.segments) {
    parts_->add(segment, names);
  }
  for (const BusConfiguration& bus : configuration.buses) {
    parts_->add(bus, names);
  }
  parts_->connect_lines(configuration);
  for (const EventConfiguration& event : configuration.events) {
    if (const auto* input = std::get_if<InputEvent>(&event.event)) {
      static_cast<void>(parts_->find_input(*input));
    }
  }
  if (!configuration.wires.empty()) {
    couple(std::make_unique<Wires>(configuration.wires));
  }
  if (configuration.trace) {
    parts_->begin_trace(*configuration.trace, configuration.clock);
  }
  if (configuration.record) {
    parts_->recorder.emplace(configuration.record->file,
                             select_signals(signals(), configuration.record->signals),
                             configuration.record->period);
    parts_->outputs.add(parts_->recorder->output(),
                        {.name = "recording " + configuration.record->file, .records = "rows"});
  }
  parts_->ground = std::make_unique<FaultGround>(*parts_, *this);
  parts_->faults = std::make_unique<Faults>(*parts_->ground);
  for (const FaultConfiguration& fault : configuration.faults) {
    if (const auto armed = parts_->faults->inject(fault, base::SimTime()); !armed) {
      throw std::runtime_error(fault.target.text + ": " + armed.error());
    }
  }
}

Rack::~Rack() = default;

void Rack::couple(std::unique_ptr<Coupling> coupling) {
  CouplingGround ground(*parts_);
  coupling->connect(ground);
  parts_->couplings.push_back(std::move(coupling));
}

std::optional<ethercat::MasterInterface> Rack::process_frame(std::size_t segment,
                                                             std::span<std::byte> frame,
                                                             base::SimTime arrival,
                                                             ethercat::MasterInterface entry) {
  Journal* journal = listening();
  if (journal == nullptr) [[likely]] {
    return pass_frame(segment, frame, arrival, entry);
  }
  const NestedCalls nested(parts_->inside);
  journal->frame_comes(segment, entry, arrival, frame);
  const auto exit = pass_frame(segment, frame, arrival, entry);
  journal->frame_leaves(exit, frame);
  return exit;
}

std::optional<ethercat::MasterInterface> Rack::pass_frame(std::size_t segment,
                                                          std::span<std::byte> frame,
                                                          base::SimTime arrival,
                                                          ethercat::MasterInterface entry) {
  if (std::min(parts_->timetable.next(), parts_->faults->next()) <= arrival) [[unlikely]] {
    advance_to(arrival);
  }
  if (parts_->traffic != nullptr) [[unlikely]] {
    return parts_->process_watched(segment, frame, arrival, entry);
  }
  return parts_->segments[segment].segment->process(frame, arrival, entry);
}

void Rack::handle_bus_events(std::size_t segment, base::SimTime now) {
  if (Journal* journal = listening(); journal != nullptr) [[unlikely]] {
    const NestedCalls nested(parts_->inside);
    journal->command({command::TakeBusEvents{segment, now}});
    take_bus_events(segment, now);
    return;
  }
  take_bus_events(segment, now);
}

void Rack::take_bus_events(std::size_t segment, base::SimTime now) {
  if (parts_->next_coupling() <= now) {
    advance_to(now);  // what the frame changes must not pass over a wire before the frame came
  }
  for (NamedDevice& member : parts_->segments[segment].devices) {
    member.device->handle_bus_events(now);
  }
  if (parts_->faults->looking()) {
    parts_->faults->act(now);
  }
}

std::optional<ethercat::ReleasedFrame> Rack::release_frame(std::size_t segment, base::SimTime now,
                                                           std::span<std::byte> buffer) {
  ethercat::Segment& wires = *parts_->segments[segment].segment;
  if (wires.next_release() > now) {
    return std::nullopt;
  }
  Journal* journal = listening();
  const NestedCalls nested(parts_->inside);
  if (journal != nullptr) {
    journal->command({command::ReleaseFrame{segment, now}});
  }
  const auto released = wires.release(now, buffer);
  take_bus_events(segment, now);
  if (journal != nullptr) {
    journal->frame_leaves(released ? std::optional(released->exit) : std::nullopt,
                          buffer.first(released ? released->length : 0));
  }
  return released;
}

void Rack::advance(base::SimTime now) {
  if (parts_->storage != nullptr && !parts_->inside &&
      parts_->storage->completions() == DeviceStorage::Completions::before_time_moves) {
    advance_with_storage(now);
  } else {
    advance_at_once(now);
  }
  parts_->advanced_to = std::max(parts_->advanced_to, now);
}

void Rack::advance_at_once(base::SimTime now) {
  Journal* journal = listening();
  if (journal == nullptr) [[likely]] {
    advance_to(now);
    return;
  }
  const NestedCalls nested(parts_->inside);
  journal->command({command::Advance{now}});
  advance_to(now);
  journal->advanced(now);
}

void Rack::advance_to(base::SimTime now) {
  RackParts& parts = *parts_;
  const auto next_sample = [&parts] {
    return parts.recorder ? parts.recorder->next_sample() : base::SimTime::never();
  };
  const auto next_instant = [this, &parts, &next_sample] {
    return std::min({parts.timetable.next(), parts_->faults->next(), parts.next_coupling(),
                     next_sample(), parts.next_tap(), parts.lines.next_deadline()});
  };
  for (base::SimTime instant = next_instant(); instant <= now; instant = next_instant()) {
    parts.advance_devices(instant);
    parts.lines.advance(instant);
    while (parts.timetable.next() <= instant) {
      parts.apply_event(parts.timetable.take(), instant);
    }
    if (parts_->faults->next() <= instant) {
      parts_->faults->act(instant);
    }
    parts.act_couplings(instant);
    if (next_sample() <= instant) {
      parts.recorder->sample(instant);
    }
    parts.sample_taps(instant);
  }
  parts.advance_devices(now);
  if (parts.lines.next_deadline() <= now) {
    parts.lines.advance(now);  // bytes of what devices have sent on the last stretch
  }
  if (parts_->faults->looking()) {
    parts_->faults->act(now);
  }
}

void Rack::settle_line(std::size_t line, LockstepClock& clock) {
  const base::SimTime limit = clock.now() + kLongestReply;
  for (base::SimTime next = parts_->lines[line].next_reply(); next <= limit;) {
    clock.advance_to(next);
    advance(clock.now());
    next = std::max(parts_->lines[line].next_reply(), clock.now() + base::SimDuration(1));
  }
}

void Rack::settle(std::size_t bus, LockstepClock& clock) {
  advance(clock.now());
  const CanNetwork& network = *parts_->buses[bus].network;
  const can::Bus& wire = network.bus();
  const base::SimTime limit = clock.now() + kLongestSettling;
  const auto orders = [this] { return parts_->storage != nullptr ? parts_->storage->orders() : 0; };
  std::uint64_t orders_seen = parts_->orders_settled;
  base::SimTime stored;  // by then what was ordered has been answered
  while (true) {
    if (const std::uint64_t given = orders(); given != orders_seen) {
      orders_seen = given;
      stored = clock.now() + kLongestStoring;
    }
    const base::SimTime next = !wire.idle()           ? wire.next_deadline()
                               : clock.now() < stored ? std::min(network.next_deadline(), stored)
                                                      : base::SimTime::never();
    if (next > limit) {
      break;
    }
    clock.advance_to(next);
    advance(clock.now());
  }
  parts_->orders_settled = orders_seen;
}

void Rack::put(std::size_t line, std::span<const std::byte> bytes, base::SimTime now) {
  tell(command::PutBytes{line, bytes, now});
  const NestedCalls nested(parts_->inside);
  parts_->lines[line].put(bytes, now);
  if (parts_->lines.next_deadline() <= now) {
    parts_->lines.advance(now);  // answers that a device sends on another of its lines
  }
}

void Rack::apply(const RackEvent& event, base::SimTime now) {
  tell(command::ApplyEvent{event, now});
  const NestedCalls nested(parts_->inside);
  parts_->apply_event(event, now);
}

base::Expected<std::uint64_t, std::string> Rack::inject(const FaultConfiguration& fault,
                                                        base::SimTime now) {
  tell(command::InjectFault{fault, now});
  const NestedCalls nested(parts_->inside);
  return parts_->faults->inject(fault, now);
}

std::size_t Rack::clear_faults(std::optional<std::uint64_t> id, base::SimTime now) {
  tell(command::ClearFault{id, now});
  const NestedCalls nested(parts_->inside);
  return id ? std::size_t{parts_->faults->clear(*id, now) ? 1U : 0U}
            : parts_->faults->clear_all(now);
}

void Rack::set_carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                       base::SimTime now) {
  tell(command::SetCarrier{segment, interface, up, now});
  const NestedCalls nested(parts_->inside);
  const bool primary = interface == ethercat::MasterInterface::primary;
  const std::size_t at = primary ? 0 : parts_->segments[segment].devices.size() - 1;
  parts_->report(parts_->number_of({segment, at}), now, up ? kCarrierBack : kCarrierLost,
                 {primary ? base::StaticText("primary") : base::StaticText("secondary")});
  parts_->segments[segment].segment->set_carrier(interface, up);
}

void Rack::put_eoe_frame(DeviceAddress device, std::span<const std::byte> frame) {
  execute({command::PutEoeFrame{device, frame}});
}

void Rack::set_journal(Journal* journal) {
  parts_->journal = journal;
  parts_->lines.set_journal(journal);
  for (const auto& [device, port] : parts_->eoe_ports) {
    port->set_journal(journal);
  }
}

void Rack::connect_line(std::size_t line, base::Delegate<void(std::span<const std::byte>)> output) {
  parts_->lines[line].connect(output);
}

bool Rack::connect_eoe(DeviceAddress device, const EoeOutput& output) {
  const auto port = parts_->eoe_ports.find(device);
  if (port == parts_->eoe_ports.end()) {
    return false;
  }
  port->second->connect(output);
  return true;
}

base::EventReporter Rack::bus_reporter(std::size_t index) {
  return {&parts_->log, parts_->buses[index].number};
}

void Rack::set_bus_epoch(std::size_t bus, base::SimDuration epoch) {
  parts_->buses[bus].network->set_epoch(epoch);
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
