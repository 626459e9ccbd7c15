#pragma once

#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/settings/description.hpp"

namespace stator::rack {

/// Of the schema.
inline constexpr std::string_view kRackFileTitle = "Rack file of Stator";

/// What its reference and schema are named after: docs/rack-file-keys.md, rack-file.schema.json.
inline constexpr std::string_view kRackFileKind = "rack-file";

/// All keys of a rack file of devices of `catalogue`.
[[nodiscard]] settings::TableDescription describe_rack_file(const product::Catalogue& catalogue);

}  // namespace stator::rack
