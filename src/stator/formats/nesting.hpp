#pragma once

#include <cstddef>
#include <string_view>

namespace stator::formats {

/// Trees are walked and destroyed by functions that call themselves, so no text may decide how deep
/// they are.
inline constexpr std::size_t kDeepestNesting = 256;
inline constexpr std::string_view kNestedTooDeep =
    "tables and lists are nested deeper than 256; no configuration needs that, take some out";

}  // namespace stator::formats
