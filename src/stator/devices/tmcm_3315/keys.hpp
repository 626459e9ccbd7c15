#pragma once

#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices {

/// What a rack file says of a TMCM-3315 (docs/rack-file.md).
extern const settings::Section<Tmcm3315Configuration> kTmcm3315Keys;

}  // namespace stator::devices
