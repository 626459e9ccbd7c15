#include "stator/rack/core/rack.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <stdexcept>
#include <utility>

#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/faults.hpp"
#include "stator/rack/core/nested_calls.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/rack/observe/journal.hpp"
#include "stator/rack/world/input_names.hpp"

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
    : log_(log), outputs_(log), lines_(configuration.lines), timetable_(configuration.events) {
  std::vector<std::string> names;
  if (!configuration.state.empty()) {
    storage_ = std::make_unique<DeviceStorage>(configuration.state);
  }
  for (const SegmentConfiguration& segment : configuration.segments) {
    add(segment, names);
  }
  for (const BusConfiguration& bus : configuration.buses) {
    add(bus, names);
  }
  connect_lines(configuration);
  for (const EventConfiguration& event : configuration.events) {
    if (const auto* input = std::get_if<InputEvent>(&event.event)) {
      static_cast<void>(find_input(*input));
    }
  }
  connect_wires(configuration);
  if (configuration.trace) {
    begin_trace(*configuration.trace, configuration.clock);
  }
  if (configuration.record) {
    recorder_.emplace(configuration.record->file,
                      select_signals(signals(), configuration.record->signals),
                      configuration.record->period);
    outputs_.add(recorder_->output(),
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

void Rack::begin_trace(const TraceConfiguration& configuration, ClockKind clock) {
  std::set<std::string> names;
  for (SegmentMembers& members : segments_) {
    for (NamedDevice& member : members.devices) {
      const std::optional<product::TracedPins> pins = member.device->traced_pins();
      if (pins && (configuration.device.empty() || configuration.device == member.name)) {
        trace_ = std::make_unique<PinTrace>(*pins, configuration, clock);
        outputs_.add(trace_->output(),
                     {.name = "trace " + configuration.file,
                      .records = "pieces",
                      .device = static_cast<std::uint16_t>(members.first_device +
                                                           (&member - members.devices.data())),
                      .always_waits = true});
        return;
      }
      if (pins) {
        names.insert(member.name);
      }
    }
  }
  if (names.empty()) {
    throw std::runtime_error("there is nothing to trace: the rack has no TMC8461");
  }
  throw std::runtime_error("there is no TMC8461 \"" + configuration.device +
                           "\" to trace; there is \"" + *names.begin() + "\"");
}

// Here at once, as is a bus: should a device be refused what is kept for it, the storage, which
// goes first, still knows those before it.
void Rack::add(const SegmentConfiguration& segment, std::vector<std::string>& names) {
  SegmentMembers& members = segments_.emplace_back();
  members.segment = std::make_unique<ethercat::Segment>();
  members.first_device = static_cast<std::uint16_t>(names.size());
  for (const DeviceConfiguration& device : segment.devices) {
    const base::EventReporter reporter(&log_, static_cast<std::uint16_t>(names.size()));
    names.push_back(device.name);
    log_.set_device_names(names);
    members.devices.push_back({device.name, make_ethercat_device(device.setup, reporter)});
    members.inputs.push_back(members.devices.back().device->inputs());
    if (storage_ != nullptr) {
      storage_->attach(device.name, *members.devices.back().device, reporter);
    }
    ethercat::SlaveController& controller = members.devices.back().device->controller();
    // Of the inputs that faults hold the one that a rack file can have set beforehand.
    held_inputs_[{{segments_.size() - 1, members.devices.size() - 1, NetworkKind::segment},
                  product::EtherCatDevice::kClockDeviation}] =
        Held<double>(controller.configuration().clock_deviation_ppb);
    if (device.forwarding_delay) {
      controller.set_forwarding_delay(*device.forwarding_delay);
    }
    members.segment->add(controller);
  }
  connect(*members.segment, segment);
  members.segment->set_carrier(ethercat::MasterInterface::secondary, false);
}

void Rack::add(const BusConfiguration& bus, std::vector<std::string>& names) {
  BusMembers& members = buses_.emplace_back();
  members.wire = bus.wire;
  members.number = static_cast<std::uint16_t>(names.size() + bus.devices.size());
  members.network = std::make_unique<CanNetwork>(bus);
  members.network->add_files_to(outputs_, members.number);
  members.first_device = static_cast<std::uint16_t>(names.size());
  for (const DeviceConfiguration& device : bus.devices) {
    const base::EventReporter reporter(&log_, static_cast<std::uint16_t>(names.size()));
    names.push_back(device.name);
    log_.set_device_names(names);
    NamedCanDevice member{device.name, make_can_device(device.setup, reporter)};
    members.inputs.push_back(member.device->inputs());
    if (storage_ != nullptr) {
      storage_->attach(device.name, device.setup.product().identity().name(), *member.device,
                       reporter);
    }
    members.network->add(std::move(member), reporter);
    members.network->set_connected(members.inputs.size() - 1, bus.wire);
  }
  names.push_back(bus.name);
  log_.set_device_names(names);
}

void Rack::connect_lines(const RackConfiguration& configuration) {
  for (std::size_t segment = 0; segment < segments_.size(); ++segment) {
    for (std::size_t i = 0; i < segments_[segment].devices.size(); ++i) {
      lines_.add(
          {configuration.segments[segment].devices[i], *segments_[segment].devices[i].device});
    }
  }
  for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
    CanNetwork& network = *buses_[bus].network;
    for (std::size_t i = 0; i < network.devices().size(); ++i) {
      lines_.add({configuration.buses[bus].devices[i], *network.devices()[i].device, &network, i});
    }
  }
}

void Rack::connect_wires(const RackConfiguration& configuration) {
  for (const WireConfiguration& wire : configuration.wires) {
    const Wires::Touched touched =
        wire.to.kind == NetworkKind::bus
            ? Wires::Touched::bind<&CanNetwork::touched>(*buses_[wire.to.network].network)
            : Wires::Touched();
    wires_.add(wire, device(wire.from).signals(), inputs(wire.to),
               held_inputs_[{wire.to, wire.input}], touched);
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
  const NestedCalls nested(inside_);
  journal->frame_comes(segment, entry, arrival, frame);
  const auto exit = pass_frame(segment, frame, arrival, entry);
  journal->frame_leaves(exit, frame);
  return exit;
}

std::optional<ethercat::MasterInterface> Rack::pass_frame(std::size_t segment,
                                                          std::span<std::byte> frame,
                                                          base::SimTime arrival,
                                                          ethercat::MasterInterface entry) {
  if (std::min(timetable_.next(), faults_->next()) <= arrival) [[unlikely]] {
    advance_to(arrival);
  }
  if (traffic_ != nullptr) [[unlikely]] {
    return process_watched(segment, frame, arrival, entry);
  }
  return segments_[segment].segment->process(frame, arrival, entry);
}

std::optional<ethercat::MasterInterface> Rack::process_watched(std::size_t segment,
                                                               std::span<std::byte> frame,
                                                               base::SimTime arrival,
                                                               ethercat::MasterInterface entry) {
  const auto network = static_cast<std::uint16_t>(segment);
  traffic_->put(network, TrafficTap::Direction::request, arrival, frame);
  const auto exit = segments_[segment].segment->process(frame, arrival, entry);
  if (exit) {
    traffic_->put(network, TrafficTap::Direction::answer, arrival, frame);
  }
  return exit;
}

void Rack::handle_bus_events(std::size_t segment, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) [[unlikely]] {
    const NestedCalls nested(inside_);
    journal->bus_events(segment, now);
    take_bus_events(segment, now);
    return;
  }
  take_bus_events(segment, now);
}

void Rack::take_bus_events(std::size_t segment, base::SimTime now) {
  if (wires_.next() <= now) {
    advance_to(now);  // what the frame changes must not pass over a wire before the frame came
  }
  for (NamedDevice& member : segments_[segment].devices) {
    member.device->handle_bus_events(now);
  }
  if (faults_->looking()) {
    faults_->act(now);
  }
}

std::optional<ethercat::ReleasedFrame> Rack::release_frame(std::size_t segment, base::SimTime now,
                                                           std::span<std::byte> buffer) {
  ethercat::Segment& wires = *segments_[segment].segment;
  if (wires.next_release() > now) {
    return std::nullopt;
  }
  Journal* journal = told();
  const NestedCalls nested(inside_);
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
  if (storage_ != nullptr && !inside_ &&
      storage_->completions() == DeviceStorage::Completions::before_time_moves) {
    advance_with_storage(now);
  } else {
    advance_at_once(now);
  }
  advanced_to_ = std::max(advanced_to_, now);
}

void Rack::advance_at_once(base::SimTime now) {
  Journal* journal = told();
  if (journal == nullptr) [[likely]] {
    advance_to(now);
    return;
  }
  const NestedCalls nested(inside_);
  journal->advance(now);
  advance_to(now);
  journal->advanced(now);
}

void Rack::advance_to(base::SimTime now) {
  const auto next_sample = [this] {
    return recorder_ ? recorder_->next_sample() : base::SimTime::never();
  };
  const auto next_instant = [this, &next_sample] {
    return std::min({timetable_.next(), faults_->next(), wires_.next(), next_sample(), next_tap(),
                     lines_.next_deadline()});
  };
  for (base::SimTime instant = next_instant(); instant <= now; instant = next_instant()) {
    advance_devices(instant);
    lines_.advance(instant);
    while (timetable_.next() <= instant) {
      happen(timetable_.take(), instant);
    }
    if (faults_->next() <= instant) {
      faults_->act(instant);
    }
    if (wires_.next() <= instant) {
      wires_.act(instant);
    }
    if (next_sample() <= instant) {
      recorder_->sample(instant);
    }
    sample_taps(instant);
  }
  advance_devices(now);
  if (lines_.next_deadline() <= now) {
    lines_.advance(now);  // bytes of what devices have sent on the last stretch
  }
  if (faults_->looking()) {
    faults_->act(now);
  }
}

base::SimTime Rack::next_bus_deadline() const {
  base::SimTime next = std::min(timetable_.next(), faults_->next());
  for (const BusMembers& members : buses_) {
    next = std::min(next, members.network->next_deadline());
  }
  return next;
}

base::SimTime Rack::next_line_deadline(std::size_t line) const {
  return std::min({timetable_.next(), faults_->next(), lines_[line].next_deadline(),
                   lines_[line].next_device_deadline()});
}

void Rack::settle_line(std::size_t line, LockstepClock& clock) {
  const base::SimTime limit = clock.now() + kLongestReply;
  for (base::SimTime next = lines_[line].next_reply(); next <= limit;) {
    clock.advance_to(next);
    advance(clock.now());
    next = std::max(lines_[line].next_reply(), clock.now() + base::SimDuration(1));
  }
}

void Rack::settle(std::size_t bus, LockstepClock& clock) {
  advance(clock.now());
  const CanNetwork& network = *buses_[bus].network;
  const can::Bus& wire = network.bus();
  const base::SimTime limit = clock.now() + kLongestSettling;
  const auto orders = [this] { return storage_ != nullptr ? storage_->orders() : 0; };
  std::uint64_t orders_seen = orders_settled_;
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
  orders_settled_ = orders_seen;
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
  const NestedCalls nested(inside_);
  lines_[line].put(bytes, now);
  if (lines_.next_deadline() <= now) {
    lines_.advance(now);  // of other lines, what a device has sent that is on several
  }
}

void Rack::apply(const RackEvent& event, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->event(event, now);
  }
  const NestedCalls nested(inside_);
  happen(event, now);
}

base::Expected<std::uint64_t, std::string> Rack::inject(const FaultConfiguration& fault,
                                                        base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->fault(fault.text, now);
  }
  const NestedCalls nested(inside_);
  return faults_->inject(fault, now);
}

std::size_t Rack::clear_faults(std::optional<std::uint64_t> id, base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->fault_cleared(id, now);
  }
  const NestedCalls nested(inside_);
  return id ? std::size_t{faults_->clear(*id, now) ? 1U : 0U} : faults_->clear_all(now);
}

void Rack::set_carrier(std::size_t segment, ethercat::MasterInterface interface, bool up,
                       base::SimTime now) {
  if (Journal* journal = told(); journal != nullptr) {
    journal->carrier(segment, interface, up, now);
  }
  const NestedCalls nested(inside_);
  const bool primary = interface == ethercat::MasterInterface::primary;
  const std::size_t at = primary ? 0 : segments_[segment].devices.size() - 1;
  report(number_of({segment, at}), now, up ? kCarrierBack : kCarrierLost,
         {primary ? base::StaticText("primary") : base::StaticText("secondary")});
  segments_[segment].segment->set_carrier(interface, up);
}

std::uint16_t Rack::number_of(DeviceAddress device) const {
  const std::size_t first = device.kind == NetworkKind::bus
                                ? buses_[device.network].first_device
                                : segments_[device.network].first_device;
  return static_cast<std::uint16_t>(first + device.device);
}

void Rack::report(std::uint16_t number, base::SimTime now, const base::EventRule& rule,
                  const Arguments& arguments) {
  log_.on_event({now, &rule, number, arguments});
}

void Rack::advance_devices(base::SimTime now) {
  for (SegmentMembers& members : segments_) {
    for (NamedDevice& member : members.devices) {
      member.device->advance(now);
    }
  }
  for (BusMembers& members : buses_) {
    members.network->advance(now);
  }
}

std::vector<product::Signal> Rack::signals() {
  std::vector<product::Signal> all;
  for (SegmentMembers& members : segments_) {
    for (NamedDevice& member : members.devices) {
      for (product::Signal signal : member.device->signals()) {
        signal.name = member.name + "." + signal.name;
        all.push_back(std::move(signal));
      }
    }
  }
  for (BusMembers& members : buses_) {
    for (NamedCanDevice& member : members.network->devices()) {
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
