#pragma once

#include <optional>
#include <string_view>

#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// The object that a key of `objects` names: "6065" or "2030:03", hexadecimal as documents write
/// it, with or without h behind the index.
[[nodiscard]] std::optional<devices::tmc8670::ObjectValue> object_named(std::string_view key);

/// Reads what a rack file says of a TMC8670 (docs/rack-file.md) over the values `configuration`
/// has. Throws RackFileError for values out of range, and for objects that do not exist or do not
/// take the value.
void read_tmc8670(TomlSection& section, devices::Tmc8670Configuration& configuration);

}  // namespace stator::rack
