#pragma once

#include "stator/devices/tmc8461/configuration.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads the keys of a TMC8461 (docs/rack-file.md) over the values `configuration` has; an EEPROM
/// image it names is read. Throws RackFileError.
void read_tmc8461(TomlSection& section, devices::Tmc8461Configuration& configuration);

}  // namespace stator::rack
