#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "stator/base/sim_time.hpp"

namespace stator::settings {

/// A duration with its unit, e.g. "250us", "1 ms", "2.5s"; empty when `text` is none.
[[nodiscard]] std::optional<base::SimDuration> parse_duration(std::string_view text);

/// The same the other way round, with the largest unit that leaves a whole number: "250us".
[[nodiscard]] std::string duration_text(base::SimDuration duration);

/// The shortest text that reads as the same number again, e.g. "0.5", "1e-05"; with `digits` that
/// many significant ones.
[[nodiscard]] std::string number_text(double value);
[[nodiscard]] std::string number_text(double value, int digits);

/// "a, b, c".
[[nodiscard]] std::string joined(const std::set<std::string>& words);

/// The entry of `known` that is most alike to `word`, else the first that begins with it, or ""
/// when none is close.
[[nodiscard]] std::string closest_match(std::string_view word, const std::set<std::string>& known);
/// What follows a word that is wrong: " (did you mean \"...\"?)", or nothing.
[[nodiscard]] std::string guess_text(std::string_view word, const std::set<std::string>& known);

}  // namespace stator::settings
