#pragma once

#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::formats {

/// The tree that a text in TOML 1.0 describes, with the place of each value; `name` stands for the
/// file in the problem of a text that is none.
[[nodiscard]] base::Expected<settings::Value, settings::Problem> parse_toml(
    std::string_view text, const std::string& name);

/// The content of a value as it stands behind "=" in TOML; of a text that is none, the text: words
/// need no quotes.
[[nodiscard]] settings::Value::Content parse_toml_value(const std::string& text);

}  // namespace stator::formats
