#pragma once

#include <string>

#include "stator/settings/description.hpp"

namespace stator::cli {

/// The keys of a rack file as tables in Markdown, docs/rack-file-keys.md.
[[nodiscard]] std::string rack_reference(const settings::TableDescription& rack_file);

/// One line per key for completion, fields separated by tabs: its path ("segment[].device[].name"),
/// the values it takes, the default, the meaning.
[[nodiscard]] std::string rack_key_paths(const settings::TableDescription& rack_file);

}  // namespace stator::cli
