#pragma once

#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads the keys of a TMCM-142 (docs/rack-file.md) over the values `configuration` has; a program
/// it names is read and assembled. Throws RackFileError, also for the first error in the program.
void read_tmcm_142(TomlSection& section, devices::Tmcm142Configuration& configuration);

}  // namespace stator::rack
