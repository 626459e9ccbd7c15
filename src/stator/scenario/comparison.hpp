#pragma once

#include <cstdint>
#include <functional>
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
  /// The same of bits under `mask`, in hexadecimal: "is 0027h".
  [[nodiscard]] std::string text_of_bits(std::int64_t mask) const;

 private:
  [[nodiscard]] std::string text_with(const std::function<std::string(double)>& number) const;
};

/// `equals`, `tolerance`, `differs`, `above` and `below`.
extern const settings::Section<Comparison> kComparisonKeys;
/// The same of a table that must have one of them, else it is told that nothing is expected.
extern const settings::Section<Comparison> kNeededComparisonKeys;
inline constexpr std::string_view kNothingExpected =
    "\"equals\" is missing; the step must say what is expected: \"equals\" (with \"tolerance\"), "
    "\"differs\", \"above\", \"below\"";

/// "006Fh": bits of a register or object as documents write them, with two, four, eight or sixteen
/// digits, as `mask`, the bits that may be set, needs.
[[nodiscard]] std::string bits_text(std::int64_t bits, std::int64_t mask);
/// "12.5 mm"; numbers as short as they are exact.
[[nodiscard]] std::string number_text(double value, std::string_view unit = {});

}  // namespace stator::scenario
