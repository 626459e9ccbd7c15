#include "stator/scenario/comparison.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace stator::scenario {

namespace {

constexpr double kAnyValue = 1e18;

}  // namespace

bool Comparison::met(double value) const {
  return (!equals || std::abs(value - *equals) <= tolerance) && (!differs || value != *differs) &&
         (!above || value > *above) && (!below || value < *below);
}

std::string number_text(double value, std::string_view unit) {
  constexpr double kExactWhole = 1e15;
  const bool whole = value == std::trunc(value) && std::abs(value) < kExactWhole;
  return fmt::format("{}{}{}", whole ? fmt::format("{:.0f}", value) : fmt::format("{}", value),
                     unit.empty() ? "" : " ", unit);
}

std::string Comparison::text(std::string_view unit) const {
  std::vector<std::string> parts;
  if (equals) {
    parts.push_back(tolerance == 0.0 ? number_text(*equals, unit)
                                     : fmt::format("{} ± {}", number_text(*equals),
                                                   number_text(tolerance, unit)));
  }
  if (differs) {
    parts.push_back("not " + number_text(*differs, unit));
  }
  if (above) {
    parts.push_back("above " + number_text(*above, unit));
  }
  if (below) {
    parts.push_back("below " + number_text(*below, unit));
  }
  return fmt::format("is {}", fmt::join(parts, " and "));
}

Comparison read_comparison(rack::TableReader& section) {
  Comparison comparison;
  comparison.equals = section.number({"equals", "The value must be this"}, -kAnyValue, kAnyValue);
  const auto tolerance =
      section.number({"tolerance", "How far it may be from equals"}, 0.0, kAnyValue);
  if (tolerance && !comparison.equals) {
    section.refuse("tolerance", "\"tolerance\" belongs to \"equals\", which is not there");
  }
  comparison.tolerance = tolerance.value_or(0.0);
  comparison.differs =
      section.number({"differs", "The value must not be this"}, -kAnyValue, kAnyValue);
  comparison.above =
      section.number({"above", "The value must be greater than this"}, -kAnyValue, kAnyValue);
  comparison.below =
      section.number({"below", "The value must be less than this"}, -kAnyValue, kAnyValue);
  return comparison;
}

Comparison require_comparison(rack::TableReader& section) {
  const Comparison comparison = read_comparison(section);
  if (comparison.empty()) {
    section.refuse_missing("equals",
                           "the step must say what is expected: \"equals\" (with \"tolerance\"), "
                           "\"differs\", \"above\", \"below\"");
  }
  return comparison;
}

}  // namespace stator::scenario
