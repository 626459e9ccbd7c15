#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/settings/value.hpp"

namespace stator::settings {

/// One step of a path: the name of a key, or the place in a list, from 0.
using PathStep = std::variant<std::string, std::size_t>;
using Path = std::vector<PathStep>;

/// Reads "gantry.axis[1].load.inertia". A name with other characters than letters, digits, "_" and
/// "-" stands in quotes: objects."2030:03". More than 256 steps are none. The error says what is
/// wrong with the text.
[[nodiscard]] base::Expected<Path, std::string> parse_path(std::string_view text);

/// The value a path leads to, or null.
[[nodiscard]] const Value* find(const Value& root, std::span<const PathStep> path);

/// Puts `value` where the path leads to, below `root`. Tables and elements of lists that are not
/// there come into being with the place of `value`; elements are tables, and no list grows beyond
/// 1,000. The error says at which step something else stands in the way.
[[nodiscard]] base::Expected<void, std::string> set(Value& root, std::span<const PathStep> path,
                                                    Value value);

}  // namespace stator::settings
