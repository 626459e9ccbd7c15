#include "stator/rack/file/wire_section.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "stator/rack/core/device_making.hpp"
#include "stator/rack/world/input_names.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

constexpr base::SimDuration kLongestDelay = 1_s;
constexpr double kAnyValue = 1e12;

}  // namespace

WireSectionReader::End WireSectionReader::read_end(TableReader& section,
                                                   const std::string& key) const {
  const bool from = key == "from";
  const std::optional<std::string> text =
      section.text({key, from ? "Device and signal that the wire begins at"
                              : "Device and input that the wire ends at"});
  if (section.describes()) {
    section.note_required(key);
    return {};
  }
  if (!text) {
    section.missing(
        key, fmt::format("it names a device and its {}, e.g. \"{}\"", from ? "signal" : "input",
                         from ? "plc.output3" : "gantry.axis0.left_switch"));
  }
  // Names of devices may contain dots, so the longest that fits is meant.
  std::optional<DeviceAddress> found;
  std::size_t length = 0;
  std::set<std::string> names;
  const auto look = [&](const std::vector<DeviceConfiguration>& devices, std::size_t network,
                        NetworkKind kind) {
    for (std::size_t i = 0; i < devices.size(); ++i) {
      const std::string& name = devices[i].name;
      names.insert(name);
      if (name.size() >= length && text->starts_with(name + ".")) {
        found = DeviceAddress{network, i, kind};
        length = name.size();
      }
    }
  };
  for (std::size_t i = 0; i < rack_.segments.size(); ++i) {
    look(rack_.segments[i].devices, i, NetworkKind::segment);
  }
  for (std::size_t i = 0; i < rack_.buses.size(); ++i) {
    look(rack_.buses[i].devices, i, NetworkKind::bus);
  }
  if (!found) {
    const std::string device = text->substr(0, text->find('.'));
    section.fail_for_reference(
        key, fmt::format("\"{}\" is \"{}\", which does not begin with a device and a dot{}; the "
                         "devices are: {}",
                         key, *text, settings::guess_text(device, names), fmt::join(names, ", ")));
  }
  return {*found, text->substr(length + 1)};
}

const WireSectionReader::Terminals& WireSectionReader::terminals_of(DeviceAddress address) {
  const auto [place, is_new] = terminals_.try_emplace(address);
  if (is_new) {
    const std::vector<DeviceConfiguration>& devices = address.kind == NetworkKind::bus
                                                          ? rack_.buses[address.network].devices
                                                          : rack_.segments[address.network].devices;
    const auto device = devices[address.device].setup.make();
    for (const product::Signal& signal : device->signals()) {
      place->second.signals.insert(signal.name);
    }
    const std::vector<product::Input> inputs = device->inputs();
    place->second.inputs.assign(inputs.begin(), inputs.end());
  }
  return place->second;
}

void WireSectionReader::read_levels(TableReader& section, const product::InputRange& input,
                                    WireConfiguration& wire) {
  const auto scale =
      section.number({"scale", "Instead of a threshold: the input follows the signal times this"},
                     -kAnyValue, kAnyValue);
  const auto offset =
      section.number({"offset", "Added to the scaled signal"}, -kAnyValue, kAnyValue);
  const auto threshold = section.number(
      {"threshold", "From this value on the signal counts as high"}, -kAnyValue, kAnyValue);
  const auto low =
      section.number({"low", "Value of the input while the signal is low"}, -kAnyValue, kAnyValue);
  const auto high = section.number({"high", "Value of the input while the signal is high"},
                                   -kAnyValue, kAnyValue);
  for (const auto& [key, value] : {std::pair("low", low), std::pair("high", high)}) {
    if (value && (*value < input.minimum || *value > input.maximum)) {
      section.refuse(key, fmt::format(R"("{}" is {}; the input "{}" takes {} to {})", key, *value,
                                      input.name, input.minimum, input.maximum));
    }
  }
  const auto inverted = section.boolean({"inverted", "High and low are exchanged"});
  if (scale || offset) {
    if (threshold || low || high || inverted) {
      section.refuse(threshold ? "threshold"
                     : low     ? "low"
                     : high    ? "high"
                               : "inverted",
                     "a wire is analog, with \"scale\" and \"offset\", or digital, with "
                     "\"threshold\", \"low\", \"high\" and \"inverted\"");
    }
    wire.threshold = std::nullopt;
    wire.scale = scale.value_or(1.0);
    wire.offset = offset.value_or(0.0);
    return;
  }
  wire.threshold = threshold.value_or(0.5);
  wire.low = low.value_or(std::clamp(0.0, input.minimum, input.maximum));
  wire.high = high.value_or(std::clamp(1.0, input.minimum, input.maximum));
  if (inverted.value_or(false)) {
    std::swap(wire.low, wire.high);
  }
}

void WireSectionReader::check_driver(TableReader& section, const End& from, const End& to) {
  if (drivers_.contains(to)) {
    section.refuse("to", "another [[wire]] leads to this input already; an input has one wire");
    return;
  }
  for (const EventConfiguration& event : rack_.events) {
    const auto* input = std::get_if<InputEvent>(&event.event);
    if (input != nullptr && input->device == to.device && input->input == to.name) {
      section.refuse("to", "an [[event]] sets this input; it can have a wire or events");
      return;
    }
  }
  // A pin of a chip is a signal and an input of the same name, so wires can form a ring.
  for (const End* end = &from;;) {
    if (*end == to) {
      section.refuse("to",
                     "the wire leads back to where its signal comes from; wires must not form a "
                     "ring");
      return;
    }
    const auto driver = drivers_.find(*end);
    if (driver == drivers_.end()) {
      break;
    }
    end = &driver->second;
  }
  drivers_.emplace(to, from);
}

product::InputRange WireSectionReader::input_between(TableReader& section, const End& from,
                                                     const End& to) {
  if (section.describes()) {
    return {};
  }
  const Terminals& source = terminals_of(from.device);
  if (!source.signals.contains(from.name)) {
    section.fail(
        "from",
        fmt::format("there is no signal \"{}\"{}; \"stator describe DEVICE --signals\" lists "
                    "the signals",
                    from.name, settings::guess_text(from.name, source.signals)));
  }
  const std::vector<product::InputRange>& inputs = terminals_of(to.device).inputs;
  const auto input = std::ranges::find(inputs, to.name, &product::InputRange::name);
  if (input == inputs.end()) {
    section.fail("to", input_problem(inputs, to.name, 0.0));
  }
  return *input;
}

WireConfiguration WireSectionReader::read(TableReader& section) {
  const End from = read_end(section, "from");
  const End to = read_end(section, "to");
  WireConfiguration wire{from.device, from.name, to.device, to.name};
  read_levels(section, input_between(section, from, to), wire);
  wire.delay = section
                   .duration({"delay", "A multiple of 50us after which the input follows"}, 0_ns,
                             kLongestDelay)
                   .value_or(0_ns);
  if (wire.delay.nanoseconds() % kWirePeriod.nanoseconds() != 0) {
    section.refuse("delay", "\"delay\" must be a multiple of 50us, at which wires act");
  }
  if (!section.describes()) {
    check_driver(section, from, to);
  }
  section.finish();
  return wire;
}

}  // namespace stator::rack
