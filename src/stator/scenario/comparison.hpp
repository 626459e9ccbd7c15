#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "stator/settings/key.hpp"

namespace stator::scenario {

/// What a number must be.
struct Comparison {
  std::optional<double> equals{};
  double tolerance = 0.0;  ///< of `equals`, to both sides
  std::optional<double> differs{};
  std::optional<double> above{};
  std::optional<double> below{};

  /// Nothing is asked of the number.
  [[nodiscard]] bool empty() const { return !equals && !differs && !above && !below; }
  [[nodiscard]] bool met(double value) const;
  /// "is 100 ± 2 mm", "is above 3 and below 5".
  [[nodiscard]] std::string text(std::string_view unit = {}) const;
};

/// `equals`, `tolerance`, `differs`, `above` and `below`.
extern const settings::Section<Comparison> kComparisonKeys;
/// The same of a table that must have one of them, else it is told that nothing is expected.
extern const settings::Section<Comparison> kNeededComparisonKeys;
inline constexpr std::string_view kNothingExpected =
    "\"equals\" is missing; the step must say what is expected: \"equals\" (with \"tolerance\"), "
    "\"differs\", \"above\", \"below\"";

/// "12.5 mm"; numbers as short as they are exact.
[[nodiscard]] std::string number_text(double value, std::string_view unit = {});

}  // namespace stator::scenario
