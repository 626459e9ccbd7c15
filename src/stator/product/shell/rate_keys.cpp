#include "stator/product/shell/rate_keys.hpp"

#include <algorithm>
#include <string>

namespace stator::product {

std::optional<std::size_t> read_rate(const settings::KeyWords& key, settings::Reader& reader,
                                     settings::WholeRange range,
                                     std::span<const std::int64_t> rates, std::string_view who) {
  const auto rate = reader.integer(key, range.minimum, range.maximum);
  if (!rate) {
    return std::nullopt;
  }
  const auto found = std::ranges::find(rates, *rate);
  if (found != rates.end()) {
    return static_cast<std::size_t>(found - rates.begin());
  }
  std::string known;
  for (const std::int64_t each : rates) {
    known += (known.empty() ? "" : ", ") + std::to_string(each);
  }
  reader.refuse(key.name, '"' + key.name + "\" is " + std::to_string(*rate) + ' ' + key.unit +
                              "; " + std::string(who) + " knows " + known);
  return std::nullopt;
}

}  // namespace stator::product
