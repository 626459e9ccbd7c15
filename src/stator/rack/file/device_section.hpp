#pragma once

#include <set>
#include <string>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// What the devices of a rack are read with.
struct DeviceReading {
  const product::Catalogue& catalogue;
  std::set<std::string> names{};  ///< of those read so far
};

/// Reads what a device of every kind has: type, name, serial lines and the keys of its product. The
/// type must be one for `network`, the name becomes one of the names. Throws RackFileError.
[[nodiscard]] DeviceConfiguration read_device(TomlSection& section, DeviceReading& reading,
                                              NetworkKind network);

}  // namespace stator::rack
