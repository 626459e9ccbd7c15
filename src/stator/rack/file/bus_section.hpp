#pragma once

#include <set>
#include <string>
#include <vector>

#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads the [[bus]] tables of a rack file and appends them to `buses`. The names of buses and
/// their devices become some of `names`. Throws RackFileError.
void read_buses(TomlSection& root, std::set<std::string>& names,
                std::vector<BusConfiguration>& buses);

}  // namespace stator::rack
