#include "replay/random_sessions/random_rack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/faults/fault_kinds.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::tests {

namespace {

using base::Random;
using base::SimDuration;
using rack::FaultParameter;
using rack::FaultScope;
using rack::FaultValueType;
using rack::NetworkKind;
using rack::RackConfiguration;

/// Within which events and faults of the rack's file begin.
constexpr SimDuration kWithin{40'000'000};
constexpr int kTries = 8;

bool chance(Random& random, double probability) {
  return random.uniform() < probability;
}

template <typename List>
const auto& one_of(Random& random, const List& list) {
  return list[random.below(list.size())];
}

SimDuration microseconds(Random& random, std::uint64_t from, std::uint64_t to) {
  return SimDuration(static_cast<std::int64_t>((from + random.below(to - from + 1)) * 1000));
}

/// Takes a product out of its box, with cables at some of its serial interfaces.
rack::DeviceConfiguration device(Random& random, std::string_view type, std::string name,
                                 const std::vector<std::string>& links) {
  RackConfiguration box = rack::single_device_rack(type, devices::products());
  rack::DeviceConfiguration device =
      box.segments.empty() ? box.buses[0].devices[0] : box.segments[0].devices[0];
  device.name = std::move(name);
  device.serial.clear();
  if (type == "tmcc160") {
    device.setup.as<devices::Tmcc160Configuration>().boot_time = SimDuration(2'000'000);
  }
  for (const product::SerialInterface& interface :
       device.setup.product().identity().serial_interfaces) {
    if (!links.empty() && chance(random, 0.6)) {
      device.serial.push_back({interface.name, one_of(random, links)});
    }
  }
  return device;
}

void add_segments(Random& random, RackConfiguration& rack, const std::vector<std::string>& links) {
  static constexpr std::array<std::string_view, 5> kTypes{"tmcm-3315", "tmcm-3315", "tmc8670",
                                                          "tmc8461", "tmc8461"};
  for (std::uint64_t count = random.below(3); count > 0; --count) {
    rack::SegmentConfiguration segment;
    for (std::uint64_t devices = 1 + random.below(2); devices > 0; --devices) {
      segment.devices.push_back(
          device(random, one_of(random, kTypes),
                 fmt::format("slave{}-{}", rack.segments.size(), segment.devices.size()), links));
    }
    rack.segments.push_back(std::move(segment));
  }
}

void add_buses(Random& random, RackConfiguration& rack, const std::vector<std::string>& links) {
  const std::uint64_t least = rack.segments.empty() ? 1 : 0;
  for (std::uint64_t count = least + random.below(3); count > 0; --count) {
    rack::BusConfiguration bus;
    const bool wire = chance(random, 0.75);
    if (wire) {
      bus.name = fmt::format("can{}", rack.buses.size());
      bus.bit_rate = chance(random, 0.7) ? std::optional(1'000'000U) : std::nullopt;
      bus.ports_acknowledge = chance(random, 0.9);
      for (std::uint64_t ports = 1 + random.below(2); ports > 0; --ports) {
        bus.ports.push_back("slcan:/tmp/none");
      }
    } else {
      bus = rack::bus_without_wire();
    }
    for (std::uint64_t devices = 1 + random.below(3); devices > 0; --devices) {
      const bool servo = wire && chance(random, 0.4);
      bus.devices.push_back(device(random, servo ? "tmcc160" : "tmcm-142",
                                   fmt::format("node{}-{}", rack.buses.size(), bus.devices.size()),
                                   links));
    }
    rack.buses.push_back(std::move(bus));
  }
}

void add_wires(Random& random, RackConfiguration& rack, const std::vector<DeviceFacts>& facts) {
  for (std::uint64_t count = random.below(3); count > 0; --count) {
    const DeviceFacts& from = one_of(random, facts);
    const DeviceFacts& to = one_of(random, facts);
    if (from.signals.empty() || to.inputs.empty()) {
      continue;
    }
    rack::WireConfiguration wire{.from = from.address,
                                 .signal = one_of(random, from.signals),
                                 .to = to.address,
                                 .input = one_of(random, to.inputs).name};
    const auto same = [&wire](const rack::WireConfiguration& other) {
      return other.to == wire.to && other.input == wire.input;
    };
    if (std::ranges::any_of(rack.wires, same)) {
      continue;
    }
    if (chance(random, 0.5)) {
      wire.threshold.reset();
    }
    wire.delay = rack::kWirePeriod * static_cast<std::int64_t>(random.below(4));
    rack.wires.push_back(wire);
  }
}

/// Most that is put on an input; of torques, in N m, far more than any shaft here stands.
constexpr double kMostValue = 60.0;
constexpr double kMostTorque = 1000.0;

double random_value(Random& random, const product::InputRange& input) {
  const double bound = input.unit.find('N') != std::string::npos ? kMostTorque : kMostValue;
  const double least = std::max(input.minimum, -bound);
  const double most = std::max(std::min(input.maximum, bound), least);
  switch (random.below(4)) {
    case 0:
      return least;
    case 1:
      return most;
    default:
      return least + (most - least) * random.uniform() * (chance(random, 0.5) ? 1.0 : 0.01);
  }
}

rack::CableEvent cable(Random& random, const DeviceFacts& device) {
  return {.device = device.address, .port = 0, .intact = chance(random, 0.6)};
}

rack::RackEvent frame_fault(Random& random, const DeviceFacts& device) {
  if (device.address.kind == NetworkKind::bus) {
    rack::FrameFaultEvent event{.bus = device.address.network};
    event.fault.kind = static_cast<can::FrameFaultKind>(random.below(4));
    event.fault.frames = static_cast<unsigned>(1 + random.below(4));
    event.fault.delay = microseconds(random, 10, 3000);
    if (chance(random, 0.5)) {
      event.device = device.address.device;
    }
    return event;
  }
  rack::SegmentFaultEvent event{.segment = device.address.network};
  event.fault.kind = static_cast<ethercat::FrameFaultKind>(random.below(5));
  event.fault.port = {device.address.device, 0};
  event.fault.leaving = chance(random, 0.5);
  event.fault.frames = static_cast<unsigned>(1 + random.below(3));
  event.fault.delay = microseconds(random, 10, 3000);
  return event;
}

std::string duration(SimDuration value) {
  return fmt::format("\"{}us\"", std::max<std::int64_t>(value.nanoseconds() / 1000, 1));
}

std::string words_one_of(Random& random, std::string_view words) {
  std::vector<std::string> all;
  while (!words.empty()) {
    const std::size_t end = std::min(words.find(' '), words.size());
    all.emplace_back(words.substr(0, end));
    words.remove_prefix(std::min(end + 1, words.size()));
  }
  return one_of(random, all);
}

/// A value of a parameter as a rack file has it; empty: none is known.
std::string value_of(Random& random, const FaultParameter& parameter,
                     const product::InputRange* input) {
  const double least = parameter.minimum;
  const double most = std::min(parameter.maximum, least + (chance(random, 0.5) ? 10.0 : 1e6));
  switch (parameter.type) {
    case FaultValueType::whole:
      return fmt::format(
          "{}", static_cast<std::int64_t>(std::floor(least + (most - least) * random.uniform())));
    case FaultValueType::number:
      return input != nullptr ? fmt::format("{:.6f}", random_value(random, *input))
                              : fmt::format("{:.6f}", least + (most - least) * random.uniform());
    case FaultValueType::duration:
      return duration(microseconds(random, static_cast<std::uint64_t>(std::ceil(least * 1e6)),
                                   static_cast<std::uint64_t>(std::ceil(least * 1e6)) + 8000));
    case FaultValueType::choice:
      return fmt::format("\"{}\"", words_one_of(random, parameter.choices));
    case FaultValueType::text:
      if (parameter.name == "input" && input != nullptr) {
        return fmt::format("\"{}\"", input->name);
      }
      return parameter.name == "object" ? "\"6060\"" : "";
  }
  return "";
}

std::string target_of(Random& random, FaultScope scope, const RackConfiguration& rack,
                      const DeviceFacts& device) {
  if (scope == FaultScope::bus && device.address.kind == NetworkKind::bus && chance(random, 0.5)) {
    return fmt::format("bus = \"{}\"\n", rack.buses[device.address.network].name);
  }
  return fmt::format("device = \"{}\"\n", device.name);
}

std::string milestone(Random& random, const DeviceFacts& device) {
  const auto few = [&random] { return 1 + random.below(12); };
  switch (random.below(6)) {
    case 0:
      return fmt::format("when = {{ cycles = {} }}\n", few());
    case 1:
      return fmt::format("when = {{ message = {} }}\n", few());
    case 2:
      return fmt::format("when = {{ sdo = \"1018\", count = {} }}\n", 1 + random.below(3));
    case 3:
      return "when = { network_state = \"operational\" }\n";
    case 4:
      return fmt::format("when = {{ frame = {}, count = {} }}\n", 0x581 + random.below(3),
                         1 + random.below(3));
    default:
      return device.signals.empty() ? ""
                                    : fmt::format("when = {{ signal = \"{}\", value = {:.3f} }}\n",
                                                  one_of(random, device.signals), random.uniform());
  }
}

}  // namespace

std::vector<DeviceFacts> facts_of(rack::Rack& rack) {
  std::vector<DeviceFacts> all;
  for (const rack::DeviceAddress address : rack.addresses()) {
    DeviceFacts facts{.address = address,
                      .name = rack.name_of(address),
                      .inputs = rack.inputs(address),
                      .signals = {}};
    for (const product::Signal& signal : rack.device(address).signals()) {
      facts.signals.push_back(signal.name);
    }
    all.push_back(std::move(facts));
  }
  return all;
}

std::optional<rack::RackEvent> random_event(Random& random, const RackConfiguration& rack,
                                            const std::vector<DeviceFacts>& facts) {
  const DeviceFacts& device = one_of(random, facts);
  const bool on_bus = device.address.kind == NetworkKind::bus;
  const bool wire = !on_bus || rack.buses[device.address.network].wire;
  switch (random.below(8)) {
    case 0:
      return wire ? std::optional<rack::RackEvent>(cable(random, device)) : std::nullopt;
    case 1:
      return rack::PowerEvent{.device = device.address, .on = chance(random, 0.6)};
    case 2:
      if (on_bus && wire) {
        return rack::ErrorStateEvent{.device = device.address,
                                     .state = chance(random, 0.5) ? can::ErrorState::bus_off
                                                                  : can::ErrorState::error_passive};
      }
      return std::nullopt;
    case 3:
      return wire ? std::optional(frame_fault(random, device)) : std::nullopt;
    default:
      if (device.inputs.empty()) {
        return std::nullopt;
      }
      const product::InputRange& input = one_of(random, device.inputs);
      return rack::InputEvent{.device = device.address,
                              .input = input.name,
                              .value = random_value(random, input),
                              .logged = chance(random, 0.8)};
  }
}

std::string random_fault(Random& random, const RackConfiguration& rack,
                         const std::vector<DeviceFacts>& facts, SimDuration until) {
  for (int i = 0; i < kTries; ++i) {
    const rack::FaultKind& kind = one_of(random, rack::fault_kinds());
    const DeviceFacts& device = one_of(random, facts);
    const product::InputRange* input =
        device.inputs.empty() ? nullptr : &one_of(random, device.inputs);
    std::string text = fmt::format("kind = \"{}\"\n", kind.name);
    text += target_of(random, kind.scope, rack, device);
    for (const FaultParameter& parameter : kind.parameters) {
      if (!parameter.needed && chance(random, 0.6)) {
        continue;
      }
      if (const std::string value = value_of(random, parameter, input); !value.empty()) {
        text += fmt::format("{} = {}\n", parameter.name, value);
      }
    }
    if (chance(random, 0.3)) {
      text += milestone(random, device);
    } else if (chance(random, 0.3)) {
      text += fmt::format("at = {}\n",
                          duration(microseconds(
                              random, 1, static_cast<std::uint64_t>(until.nanoseconds() / 1000))));
    }
    if (chance(random, 0.2)) {
      text += fmt::format("wait = {}\n", duration(microseconds(random, 1, 5000)));
    }
    if (!kind.counted.empty() && chance(random, 0.7)) {
      text += fmt::format("count = {}\n", 1 + random.below(20));
      if (chance(random, 0.5)) {
        text += fmt::format("probability = {:.2f}\nseed = {}\n", 0.05 + 0.9 * random.uniform(),
                            random.below(1000));
      }
    } else if (!kind.momentary && chance(random, 0.8)) {
      text += fmt::format("for = {}\n", duration(microseconds(random, 1, 12000)));
    }
    try {
      static_cast<void>(rack::parse_fault(text, rack));
      return text;
    } catch (const std::runtime_error&) {
      continue;  // not of this device, or not these keys together
    }
  }
  return "";
}

RackConfiguration random_rack(std::uint64_t seed) {
  Random random(seed * 2 + 1);
  RackConfiguration rack;
  rack.clock = chance(random, 0.5) ? rack::ClockKind::real : rack::ClockKind::lockstep;
  std::vector<std::string> links;
  for (std::uint64_t count = random.below(5); count > 0; --count) {
    links.push_back(fmt::format("pty:/tmp/none{}", links.size()));
    if (chance(random, 0.6)) {
      rack.lines.push_back({.link = links.back(), .pacing = chance(random, 0.6)});
    }
  }
  add_segments(random, rack, links);
  add_buses(random, rack, links);
  rack::EventLog log;
  rack::Rack probe(rack, log);
  const std::vector<DeviceFacts> facts = facts_of(probe);
  for (std::uint64_t count = random.below(6); count > 0; --count) {
    if (auto event = random_event(random, rack, facts)) {
      rack.events.push_back(
          {microseconds(random, 1, static_cast<std::uint64_t>(kWithin.nanoseconds() / 1000)),
           std::move(*event)});
    }
  }
  for (std::uint64_t count = random.below(4); count > 0; --count) {
    const std::string text = random_fault(random, rack, facts, kWithin);
    if (text.empty()) {
      continue;
    }
    const rack::FaultConfiguration fault = rack::parse_fault(text, rack);
    if (probe.inject(fault, {})) {
      rack.faults.push_back(fault);
    }
  }
  add_wires(random, rack, facts);
  return rack;
}

}  // namespace stator::tests
