#pragma once

#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices {

/// What a rack file says of a TMCM-142 (docs/rack-file.md); a program it names is assembled.
extern const settings::Section<Tmcm142Configuration> kTmcm142Keys;

}  // namespace stator::devices
