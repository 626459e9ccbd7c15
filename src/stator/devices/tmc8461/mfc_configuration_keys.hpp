#pragma once

#include <string>

#include "stator/devices/tmc8461/sii.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/settings/reader.hpp"

namespace stator::devices::tmc8461 {

/// What a configuration file of a TMC8461 says: the configuration that its EEPROM loads, and who
/// the board is (docs/how-to/mfc-configuration.md).
struct MfcConfigurationFile {
  BoardIdentity identity;
  mfc::Configuration configuration;
};

/// Reads and checks the tree of such a file. Refused are unknown keys, names, signals; lines of
/// differential pairs with a signal or different slopes; blocks outside 1000h..4FFFh or
/// overlapping, three buffers counted. If anything is refused, `content` is of no use.
void read_mfc_configuration(settings::Reader& root, MfcConfigurationFile& content);

/// A file from which the same is read.
[[nodiscard]] std::string mfc_configuration_text(const MfcConfigurationFile& content);

}  // namespace stator::devices::tmc8461
