#include "stator/rack/world/input_names.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "stator/settings/words.hpp"

namespace stator::rack {

std::string input_problem(std::span<const product::InputRange> inputs, const std::string& name,
                          double value) {
  const auto input = std::ranges::find(inputs, name, &product::InputRange::name);
  if (input != inputs.end()) {
    if (value >= input->minimum && value <= input->maximum) {
      return "";
    }
    return fmt::format("{} is set to {}; it takes {} to {}{}{}", name, value, input->minimum,
                       input->maximum, input->unit.empty() ? "" : " ", input->unit);
  }
  std::set<std::string> names;
  for (const product::InputRange& known : inputs) {
    names.insert(known.name);
  }
  const std::string guess = settings::closest_match(name, names);
  return fmt::format("there is no input \"{}\"{}; the inputs are: {}", name,
                     guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                     fmt::join(names, ", "));
}

}  // namespace stator::rack
