#pragma once

#include <set>
#include <string>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads what a device of every kind has: type, name, serial lines and the keys of its product. The
/// type must be one for `network`, the name becomes one of `names`. Throws RackFileError.
[[nodiscard]] DeviceConfiguration read_device(TomlSection& section, std::set<std::string>& names,
                                              NetworkKind network);

}  // namespace stator::rack
