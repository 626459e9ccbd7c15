#pragma once

#include "stator/devices/tmc8461/configuration.hpp"
#include "stator/settings/key.hpp"

namespace stator::devices {

/// The keys of a TMC8461 (docs/rack-file.md). An EEPROM image or a configuration of the I/O block
/// that they name is read; the configuration gives the board's identity, too.
extern const settings::Section<Tmc8461Configuration> kTmc8461Keys;

}  // namespace stator::devices
