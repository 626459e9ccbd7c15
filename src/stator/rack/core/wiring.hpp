#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/ethercat/segment/segment.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::rack {

/// Both ends of the cable in front of a device.
struct Attachment {
  std::optional<std::size_t> parent;  ///< device of the segment; nothing: the master
  unsigned parent_port = 0;
  unsigned port = 0;  ///< of the device itself
};

/// Where the device at `index` hangs. A configuration that says nothing gives a line: port 1 of the
/// device before, or port 0 of one that is entered through port 1.
[[nodiscard]] Attachment attachment_of(std::span<const DeviceConfiguration> devices,
                                       std::size_t index);

/// The port that leads away from the master in a line: where the next device or the redundant link
/// goes.
[[nodiscard]] unsigned far_port(const DeviceConfiguration& device);

/// The device of the segment that hangs at `port` of the device at `index`.
[[nodiscard]] std::optional<std::size_t> device_at(std::span<const DeviceConfiguration> devices,
                                                   std::size_t index, unsigned port);

/// A cable of any kind ends at `port` of the device at `index`.
[[nodiscard]] bool has_cable(const SegmentConfiguration& segment, std::size_t index, unsigned port);

/// The devices in the order in which a frame of the primary interface passes them while all cables
/// are whole: that in which masters count them. In a line and a ring it is that of the
/// configuration; from a branching point the branch at port 3 comes first, then those at 1 and 2.
[[nodiscard]] std::vector<std::size_t> frame_order(const SegmentConfiguration& segment);

/// Why `segment` cannot have the redundant link it names, as a sentence with remedy: a ring needs
/// two network interfaces, of which the first may still be left to the command line. Empty if it
/// can, or names none.
[[nodiscard]] std::string redundancy_problem(const SegmentConfiguration& segment);

/// Connects the slaves of `segment`, which are added already, in the order of the configuration.
/// Throws std::logic_error if a port does not exist or is taken, which reading a rack file
/// excludes.
void connect(ethercat::Segment& segment, const SegmentConfiguration& configuration);

}  // namespace stator::rack
