#include "stator/scenario/comparison.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <fmt/format.h>

namespace stator::scenario {

namespace {

constexpr settings::Range kAnyValue{-1e18, 1e18};

void read_tolerance(const settings::KeyWords& key, settings::Reader& reader,
                    Comparison& comparison) {
  const auto tolerance = reader.number(key, 0.0, kAnyValue.maximum);
  if (tolerance && !comparison.equals) {
    reader.refuse(key.name, R"("tolerance" belongs to "equals", which is not there)");
  }
  comparison.tolerance = tolerance.value_or(0.0);
}

constexpr std::array kComparisonRows{
    settings::number<&Comparison::equals>("equals", kAnyValue, "The value must be this"),
    settings::custom<Comparison, read_tolerance>("tolerance", "How far it may be from equals"),
    settings::number<&Comparison::differs>("differs", kAnyValue, "The value must not be this"),
    settings::number<&Comparison::above>("above", kAnyValue, "The value must be greater than this"),
    settings::number<&Comparison::below>("below", kAnyValue, "The value must be less than this")};

constexpr std::array kNeededComparisonRules{settings::Rule<Comparison>{
    .key = "equals",
    .holds = [](const Comparison& comparison) { return !comparison.empty(); },
    .sentence = kNothingExpected}};

}  // namespace

bool Comparison::met(double value) const {
  return (!equals || std::abs(value - *equals) <= tolerance) && (!differs || value != *differs) &&
         (!above || value > *above) && (!below || value < *below);
}

std::string bits_text(std::int64_t bits, std::int64_t mask) {
  const int digits = mask <= 0xFF ? 2 : mask <= 0xFFFF ? 4 : mask <= 0xFFFF'FFFF ? 8 : 16;
  return fmt::format("{:0{}X}h", static_cast<std::uint64_t>(bits), digits);
}

std::string number_text(double value, std::string_view unit) {
  constexpr double kExactWhole = 1e15;
  const bool whole = value == std::trunc(value) && std::abs(value) < kExactWhole;
  // Adding 0 takes the sign from one that is negative.
  return fmt::format("{}{}{}",
                     whole ? fmt::format("{:.0f}", value + 0.0) : fmt::format("{}", value),
                     unit.empty() ? "" : " ", unit);
}

std::string Comparison::text(std::string_view unit) const {
  return text_with([unit](double value) { return number_text(value, unit); });
}

std::string Comparison::text_of_bits(std::int64_t mask) const {
  return text_with([mask](double value) {
    const bool bits = value == std::trunc(value) && value >= 0.0;
    return bits ? bits_text(static_cast<std::int64_t>(value), mask) : number_text(value);
  });
}

std::string Comparison::text_with(const std::function<std::string(double)>& number) const {
  std::vector<std::string> parts;
  if (equals) {
    parts.push_back(tolerance == 0.0
                        ? number(*equals)
                        : fmt::format("{} ± {}", number_text(*equals), number(tolerance)));
  }
  if (differs) {
    parts.push_back("not " + number(*differs));
  }
  if (above) {
    parts.push_back("above " + number(*above));
  }
  if (below) {
    parts.push_back("below " + number(*below));
  }
  return fmt::format("is {}", fmt::join(parts, " and "));
}

constinit const settings::Section<Comparison> kComparisonKeys{kComparisonRows};
constinit const settings::Section<Comparison> kNeededComparisonKeys{kComparisonRows,
                                                                    kNeededComparisonRules};

}  // namespace stator::scenario
