#pragma once

#include <string>

#include "stator/settings/value.hpp"

namespace stator::settings {

/// A table as TOML, one line for each of its values, tables within it in braces; reading it gives
/// the same table. What no key takes is left out.
[[nodiscard]] std::string toml_text(const Table& table);

}  // namespace stator::settings
