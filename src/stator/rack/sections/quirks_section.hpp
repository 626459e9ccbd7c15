#pragma once

#include "stator/dictionary/quirks.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// The networks a device can be on, as far as quirks go.
enum class QuirkKind : std::uint8_t { coe, canopen };

/// Reads the key "quirks" of a device: a list of names, or a table of names with parameters
/// (docs/how-to/quirks.md).
void read_quirks(TomlSection& section, QuirkKind kind, dictionary::Quirks& quirks);

}  // namespace stator::rack
