#pragma once

#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/settings/description.hpp"

namespace stator::rack {

/// Of the schema.
inline constexpr std::string_view kRackFileTitle = "Rack file of Stator";

/// All keys of a rack file of devices of `catalogue`.
[[nodiscard]] settings::TableDescription describe_rack_file(const product::Catalogue& catalogue);

}  // namespace stator::rack
