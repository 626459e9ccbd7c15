#pragma once

#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices {

/// What a rack file says of a TMCC160 (docs/rack-file.md). `friendly = true` sets the options of
/// tmcc160::Options::friendly(); keys of single options count beside it.
extern const settings::Section<Tmcc160Configuration> kTmcc160Keys;

}  // namespace stator::devices
