#pragma once

#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads what a rack file says of a TMCC160 (docs/rack-file.md) over the values `configuration`
/// has. `friendly = true` sets the options of tmcc160::Options::friendly(); keys for single options
/// count beside it. Throws RackFileError for values out of range.
void read_tmcc160(TomlSection& section, devices::Tmcc160Configuration& configuration);

}  // namespace stator::rack
