#pragma once

#include <functional>
#include <set>
#include <string>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

/// What the devices of a rack are read with.
struct DeviceReading {
  const product::Catalogue& catalogue;
  std::set<std::string> names{};  ///< of those read so far
};

/// Reads what a device of every kind has: type, name, serial lines and the keys of its product. The
/// type must be one for `network`, the name becomes one of the names. Then `rest` gets the device
/// and reads what else its table has. Not called if there is no type, without which a table says
/// nothing.
void read_device(TableReader& section, DeviceReading& reading, NetworkKind network,
                 const std::function<void(DeviceConfiguration)>& rest);

}  // namespace stator::rack
