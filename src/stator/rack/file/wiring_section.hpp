#pragma once

#include <span>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

/// Reads where the last one of `devices` hangs and how long cable and device delay a frame: the
/// keys `after`, `port`, `entry_port`, `cable_delay` and `forwarding_delay`. The others are above
/// it in the segment. Ends reading for a device or port that does not exist or is taken.
void read_wiring(TableReader& section, std::span<DeviceConfiguration> devices);

}  // namespace stator::rack
