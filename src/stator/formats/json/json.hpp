#pragma once

#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::formats {

/// The tree that a text in JSON describes, the same as that of a TOML file with these values: whole
/// numbers are std::int64_t, those beyond it and all with a point or an exponent doubles, null is
/// std::monostate. Each value has its place. Refused are a name that stands twice in an object and
/// what is nested deeper than 256. `name` stands for the file in the problem of a text that is
/// none.
[[nodiscard]] base::Expected<settings::Value, settings::Problem> parse_json(
    std::string_view text, const std::string& name);

}  // namespace stator::formats
