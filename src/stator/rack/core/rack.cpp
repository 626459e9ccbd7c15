#include "stator/rack/core/rack.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "stator/rack/core/faults.hpp"
#include "stator/rack/core/internal/rack_parts.hpp"
#include "stator/rack/core/nested_calls.hpp"
#include "stator/rack/observe/journal.hpp"

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
    : parts_(std::make_unique<Parts>(configuration, log)) {
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
  connect_wires(configuration);
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
  faults_ = std::make_unique<Faults>(*this);
  for (const FaultConfiguration& fault : configuration.faults) {
    if (const auto armed = faults_->inject(fault, base::SimTime()); !armed) {
      throw std::runtime_error(fault.target.text + ": " + armed.error());
    }
  }
}

Rack::~Rack() = default;

Journal* Rack::told() {
  return parts_->inside ? nullptr : parts_->journal;
}

void Rack::connect_wires(const RackConfiguration& configuration) {
  for (const WireConfiguration& wire : configuration.wires) {
    const Wires::Touched touched =
        wire.to.kind == NetworkKind::bus
            ? Wires::Touched::bind<&CanNetwork::touched>(*parts_->buses[wire.to.network].network)
            : Wires::Touched();
    parts_->wires.add(wire, device(wire.from).signals(), inputs(wire.to),
                      parts_->held_inputs[{wire.to, wire.input}], touched);
  }
}

std::optional<ethercat::MasterInterface> Rack::process_frame(std::size_t segment,
                                                             std::span<std::byte> frame,
                                                             base::SimTime arrival,
                                                             ethercat::MasterInterface entry) {
  Journal* journal = told();
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
  if (std::min(parts_->timetable.next(), faults_->next()) <= arrival) [[unlikely]] {
    advance_to(arrival);
  }
  if (parts_->traffic != nullptr) [[unlikely]] {
    return parts_->process_watched(segment, frame, arrival, entry);
  }
  return parts_->segments[segment].segment->process(frame, arrival, entry);
}

void Rack::handle_bus_events(std::size_t segment, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) [[unlikely]] {
    const NestedCalls nested(parts_->inside);
    journal->bus_events(segment, now);
    take_bus_events(segment, now);
    return;
  }
  take_bus_events(segment, now);
}

void Rack::take_bus_events(std::size_t segment, base::SimTime now) {
  if (parts_->wires.next() <= now) {
    advance_to(now);  // what the frame changes must not pass over a wire before the frame came
  }
  for (NamedDevice& member : parts_->segments[segment].devices) {
    member.device->handle_bus_events(now);
  }
  if (faults_->looking()) {
    faults_->act(now);
  }
}

std::optional<ethercat::ReleasedFrame> Rack::release_frame(std::size_t segment, base::SimTime now,
                                                           std::span<std::byte> buffer) {
  ethercat::Segment& wires = *parts_->segments[segment].segment;
  if (wires.next_release() > now) {
    return std::nullopt;
  }
  Journal* journal = told();
  const NestedCalls nested(parts_->inside);
  if (journal != nullptr) {
    journal->release(segment, now);
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
  Journal* journal = told();
  if (journal == nullptr) [[likely]] {
    advance_to(now);
    return;
  }
  const NestedCalls nested(parts_->inside);
  journal->advance(now);
  advance_to(now);
  journal->advanced(now);
}

void Rack::advance_to(base::SimTime now) {
  Parts& parts = *parts_;
  const auto next_sample = [&parts] {
    return parts.recorder ? parts.recorder->next_sample() : base::SimTime::never();
  };
  const auto next_instant = [this, &parts, &next_sample] {
    return std::min({parts.timetable.next(), faults_->next(), parts.wires.next(), next_sample(),
                     parts.next_tap(), parts.lines.next_deadline()});
  };
  for (base::SimTime instant = next_instant(); instant <= now; instant = next_instant()) {
    parts.advance_devices(instant);
    parts.lines.advance(instant);
    while (parts.timetable.next() <= instant) {
      parts.happen(parts.timetable.take(), instant);
    }
    if (faults_->next() <= instant) {
      faults_->act(instant);
    }
    if (parts.wires.next() <= instant) {
      parts.wires.act(instant);
    }
    if (next_sample() <= instant) {
      parts.recorder->sample(instant);
    }
    parts.sample_taps(instant);
  }
  parts.advance_devices(now);
  if (parts.lines.next_deadline() <= now) {
    parts.lines.advance(now);  // bytes of what devices have sent on the last stretch
  }
  if (faults_->looking()) {
    faults_->act(now);
  }
}

base::SimTime Rack::next_bus_deadline() const {
  base::SimTime next = std::min(parts_->timetable.next(), faults_->next());
  for (const Parts::BusMembers& members : parts_->buses) {
    next = std::min(next, members.network->next_deadline());
  }
  return next;
}

base::SimTime Rack::next_line_deadline(std::size_t line) const {
  return std::min({parts_->timetable.next(), faults_->next(), parts_->lines[line].next_deadline(),
                   parts_->lines[line].next_device_deadline()});
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
  base::SimTime stored;  // what was ordered is answered then
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

bool Rack::put(std::size_t bus, std::size_t number, can::Port& port, const can::Frame& frame) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->can_frame_comes(bus, number, frame);
  }
  return port.put(frame);
}

std::optional<can::TimedFrame> Rack::take(std::size_t bus, std::size_t number, can::Port& port) {
  const auto frame = port.take();
  if (Journal* journal = told(); journal != nullptr && frame) {
    journal->can_frame_leaves(bus, number, *frame);
  }
  return frame;
}

void Rack::put(std::size_t line, std::span<const std::byte> bytes, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->bytes_come(line, bytes, now);
  }
  const NestedCalls nested(parts_->inside);
  parts_->lines[line].put(bytes, now);
  if (parts_->lines.next_deadline() <= now) {
    parts_->lines.advance(now);  // of other lines, what a device has sent that is on several
  }
}

void Rack::apply(const RackEvent& event, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->event(event, now);
  }
  const NestedCalls nested(parts_->inside);
  parts_->happen(event, now);
}

base::Expected<std::uint64_t, std::string> Rack::inject(const FaultConfiguration& fault,
                                                        base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->fault(fault.text, now);
  }
  const NestedCalls nested(parts_->inside);
  return faults_->inject(fault, now);
}

std::size_t Rack::clear_faults(std::optional<std::uint64_t> id, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->fault_cleared(id, now);
  }
  const NestedCalls nested(parts_->inside);
  return id ? std::size_t{faults_->clear(*id, now) ? 1U : 0U} : faults_->clear_all(now);
}

void Rack::set_carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                       base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->carrier(segment, interface, up, now);
  }
  const NestedCalls nested(parts_->inside);
  const bool primary = interface == ethercat::MasterInterface::primary;
  const std::size_t at = primary ? 0 : parts_->segments[segment].devices.size() - 1;
  parts_->report(parts_->number_of({segment, at}), now, up ? kCarrierBack : kCarrierLost,
                 {primary ? base::StaticText("primary") : base::StaticText("secondary")});
  parts_->segments[segment].segment->set_carrier(interface, up);
}

std::vector<product::Signal> Rack::signals() const {
  std::vector<product::Signal> all;
  for (const Parts::SegmentMembers& members : parts_->segments) {
    for (const NamedDevice& member : members.devices) {
      for (product::Signal signal : member.device->signals()) {
        signal.name = member.name + "." + signal.name;
        all.push_back(std::move(signal));
      }
    }
  }
  for (const Parts::BusMembers& members : parts_->buses) {
    for (const NamedCanDevice& member : members.network->devices()) {
      for (product::Signal signal : member.device->signals()) {
        signal.name = member.name + "." + signal.name;
        all.push_back(std::move(signal));
      }
    }
    if (members.wire) {
      std::ranges::move(members.network->signals(), std::back_inserter(all));
    }
  }
  return all;
}

}  // namespace stator::rack
