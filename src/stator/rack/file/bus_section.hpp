#pragma once

#include <vector>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/device_section.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

/// Reads the [[bus]] tables of a rack file and appends them to `buses`. The names of buses and
/// their devices become some of its names.
void read_buses(TableReader& root, DeviceReading& reading, std::vector<BusConfiguration>& buses);

}  // namespace stator::rack
