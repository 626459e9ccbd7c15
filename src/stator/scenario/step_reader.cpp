#include "stator/scenario/step_reader.hpp"

#include <fmt/format.h>

#include "stator/bench/bench.hpp"

namespace stator::scenario {

namespace {

constexpr unsigned kMostAxes = 6;

}  // namespace

rack::DeviceAddress StepReader::device(rack::TableReader& section) {
  std::size_t devices = 0;
  rack::DeviceAddress only;
  for (std::size_t i = 0; i < rack_.segments.size(); ++i) {
    devices += rack_.segments[i].devices.size();
    only = {i, 0, rack::NetworkKind::segment};
  }
  for (std::size_t i = 0; i < rack_.buses.size(); ++i) {
    devices += rack_.buses[i].devices.size();
    if (!rack_.buses[i].devices.empty()) {
      only = {i, 0, rack::NetworkKind::bus};
    }
  }
  if (devices == 1 && !section.contains("device")) {
    return only;
  }
  return targets_.read_target(section);
}

std::optional<rack::DeviceAddress> StepReader::any_device(rack::TableReader& section) {
  if (!section.contains("device")) {
    static_cast<void>(section.text({"device", "Name of the device; without it all"}));
    return std::nullopt;
  }
  return targets_.read_target(section);
}

unsigned StepReader::axis(rack::TableReader& section) {
  return static_cast<unsigned>(
      section.integer({"axis", "Axis of the device"}, 0, kMostAxes - 1).value_or(0));
}

std::size_t StepReader::segment(rack::TableReader& section) const {
  if (rack_.segments.empty()) {
    section.fail("do", "the rack has no EtherCAT segment");
  }
  return static_cast<std::size_t>(section
                                      .integer({"segment", "EtherCAT segment, counted from 0"}, 0,
                                               static_cast<std::int64_t>(rack_.segments.size()) - 1)
                                      .value_or(0));
}

std::size_t StepReader::bus(rack::TableReader& section) const {
  if (const auto name = section.text({"bus", "Name of the CAN bus; the first one without it"})) {
    return targets_.read_bus(section, *name);
  }
  for (std::size_t i = 0; i < rack_.buses.size(); ++i) {
    if (rack_.buses[i].wire) {
      return i;
    }
  }
  section.fail("do", "the rack has no CAN bus");
}

base::SimDuration StepReader::within(rack::TableReader& section, base::SimDuration otherwise) {
  section.duration({"within", "How long it is waited for at most, in simulated time"},
                   base::SimDuration(), kLongestStep, otherwise);
  return otherwise;
}

const dictionary::Entry* find_entry(bench::Bench& bench, rack::DeviceAddress device,
                                    master::ObjectAddress object) {
  const dictionary::Dictionary* objects = bench.rack().device(device).object_dictionary();
  return objects != nullptr ? objects->find(object.index, object.subindex) : nullptr;
}

std::string axis_text(const std::string& device, unsigned axis) {
  return fmt::format("{} axis {}", device, axis);
}

std::string duration_text(base::SimDuration duration) {
  const double seconds = duration.seconds();
  return seconds < 1.0 ? fmt::format("{:g} ms", seconds * 1e3) : fmt::format("{:g} s", seconds);
}

}  // namespace stator::scenario
