#pragma once

#include "stator/devices/junction/junction.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices {

/// What a rack file says of a junction (docs/rack-file.md).
extern const settings::Section<JunctionConfiguration> kJunctionKeys;

}  // namespace stator::devices
