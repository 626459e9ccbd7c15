#include "stator/settings/words.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"

namespace stator::settings {

std::optional<base::SimDuration> parse_duration(std::string_view text) {
  struct Unit {
    std::string_view name;
    double nanoseconds;
  };
  constexpr std::array<Unit, 4> kUnits{{{"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}}};
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number)) {
    return std::nullopt;
  }
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  while (unit.starts_with(' ')) {
    unit.remove_prefix(1);
  }
  for (const Unit& known : kUnits) {
    const double nanoseconds = number * known.nanoseconds;
    if (unit == known.name && std::abs(nanoseconds) < 9e18) {
      return base::SimDuration(std::llround(nanoseconds));
    }
  }
  return std::nullopt;
}

std::string duration_text(base::SimDuration duration) {
  const std::int64_t nanoseconds = duration.nanoseconds();
  if (nanoseconds % 1'000'000'000 == 0 && nanoseconds != 0) {
    return fmt::format("{}s", nanoseconds / 1'000'000'000);
  }
  if (nanoseconds % 1'000'000 == 0) {
    return fmt::format("{}ms", nanoseconds / 1'000'000);
  }
  if (nanoseconds % 1'000 == 0) {
    return fmt::format("{}us", nanoseconds / 1'000);
  }
  return fmt::format("{}ns", nanoseconds);
}

std::string number_text(double value) {
  return fmt::format("{}", value);
}

std::string number_text(double value, int digits) {
  return fmt::format("{:.{}g}", value, digits);
}

std::string joined(const std::set<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

std::string closest_match(std::string_view word, const std::set<std::string>& known) {
  return std::string(
      base::closest_match(word, std::vector<std::string_view>(known.begin(), known.end())));
}

std::string guess_text(std::string_view word, const std::set<std::string>& known) {
  const std::string guess = closest_match(word, known);
  return guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess);
}

}  // namespace stator::settings
