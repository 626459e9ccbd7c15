#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "stator/base/sim_time.hpp"

namespace stator::rack {

/// A duration with its unit, e.g. "250us", "1 ms", "2.5s"; empty when `text` is none.
[[nodiscard]] std::optional<base::SimDuration> parse_duration(std::string_view text);

/// The entry of `known` that is most alike to `word`, else the first that begins with it, or ""
/// when none is close.
[[nodiscard]] std::string closest_match(std::string_view word, const std::set<std::string>& known);

}  // namespace stator::rack
