#pragma once

#include <string>
#include <string_view>

#include "stator/devices/tmc8461/sii.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/rack/toml/rack_file_error.hpp"

namespace stator::rack {

/// What a configuration file of a TMC8461 says: the configuration that its EEPROM loads, and who
/// the board is (docs/how-to/mfc-configuration.md).
struct MfcConfigurationFile {
  devices::tmc8461::BoardIdentity identity;
  mfc::Configuration configuration;
};

/// Reads and checks a configuration file; `name` stands in messages. Throws RackFileError with line
/// and column: unknown keys, names, signals; lines of differential pairs with a signal or different
/// slopes; blocks outside 1000h..4FFFh or overlapping, three buffers counted. With `errors` they
/// are collected there, and the result is of no use if there is one.
[[nodiscard]] MfcConfigurationFile parse_mfc_configuration(std::string_view text,
                                                           const std::string& name,
                                                           RackFileErrors* errors = nullptr);

/// The same of the file at `path`.
[[nodiscard]] MfcConfigurationFile load_mfc_configuration(const std::string& path,
                                                          RackFileErrors* errors = nullptr);

/// A file from which parse_mfc_configuration() reads the same.
[[nodiscard]] std::string mfc_configuration_text(const MfcConfigurationFile& content);

}  // namespace stator::rack
