#pragma once

#include <optional>
#include <string>
#include <vector>

#include "stator/base/random.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::tests {

/// What a device of a rack offers to whoever wants to do something to it.
struct DeviceFacts {
  rack::DeviceAddress address;
  std::string name;
  std::vector<product::InputRange> inputs;  ///< what sets them is not to be called
  std::vector<std::string> signals;         ///< names within the device
};

/// A rack that is made of a seed: products on segments, buses and serial lines, paced or not, with
/// a timetable, faults and wires. Every call gives the same one.
[[nodiscard]] rack::RackConfiguration random_rack(std::uint64_t seed);

[[nodiscard]] std::vector<DeviceFacts> facts_of(rack::Rack& rack);

/// Something that can happen to the rack; nothing: not with what it has.
[[nodiscard]] std::optional<rack::RackEvent> random_event(base::Random& random,
                                                          const rack::RackConfiguration& rack,
                                                          const std::vector<DeviceFacts>& facts);
/// The keys of a fault of a [[fault]] table which the rack can have; empty: none was found. Those
/// with a time of their own begin before `until`.
[[nodiscard]] std::string random_fault(base::Random& random, const rack::RackConfiguration& rack,
                                       const std::vector<DeviceFacts>& facts,
                                       base::SimDuration until);

}  // namespace stator::tests
