#pragma once

#include <set>
#include <string>
#include <vector>

#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/device_section.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

/// Reads the lines to which a device's serial interfaces are connected: keys of the interfaces'
/// names.
[[nodiscard]] std::vector<SerialConnection> read_serial_connections(
    TableReader& section, const product::Identity& identity);

/// Reads the [[device]] tables of a rack file: devices that are reached over serial lines only.
/// They get a bus without wire, which becomes the last of `buses`.
void read_line_devices(TableReader& root, DeviceReading& reading,
                       std::vector<BusConfiguration>& buses);

/// Reads the [[line]] tables of a rack file, when all its devices are in `configuration`. Throws
/// RackFileError, also for a line that no device names and for one that several devices name with
/// interfaces that cannot share it.
void read_lines(TableReader& root, RackConfiguration& configuration);

}  // namespace stator::rack
