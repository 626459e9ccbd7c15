#include "rack/toml_section.hpp"

#include <utility>

#include <fmt/format.h>

#include "rack/text.hpp"

namespace stator::rack {

namespace {

std::string joined(const std::set<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

const toml::node* TomlSection::find(const std::string& key) {
  asked_.insert(key);
  return table_->get(key);
}

bool TomlSection::is_text(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_string();
}

bool TomlSection::is_boolean(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return node != nullptr && node->is_boolean();
}

void TomlSection::fail(const std::string& key, const std::string& reason) const {
  if (file_.empty()) {
    throw RackFileError(reason);
  }
  const toml::node* node = table_->get(key);
  const toml::source_position place = (node != nullptr ? node->source() : table_->source()).begin;
  throw RackFileError(
      fmt::format("{}:{}:{}: {} in {}", file_, place.line, place.column, reason, path_));
}

std::optional<std::string> TomlSection::text(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_string()) {
    fail(key, fmt::format("\"{}\" must be a text in quotes", key));
  }
  return node->as_string()->get();
}

std::optional<std::string> TomlSection::choice(const std::string& key,
                                               const std::set<std::string>& choices) {
  std::optional<std::string> value = text(key);
  if (value && !choices.contains(*value)) {
    const std::string guess = closest_match(*value, choices);
    fail(key, fmt::format("\"{}\" is \"{}\"{}; it must be one of: {}", key, *value,
                          guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                          joined(choices)));
  }
  return value;
}

std::optional<bool> TomlSection::boolean(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_boolean()) {
    fail(key, fmt::format("\"{}\" must be true or false", key));
  }
  return node->as_boolean()->get();
}

std::optional<std::int64_t> TomlSection::integer(const std::string& key, std::int64_t minimum,
                                                 std::int64_t maximum) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_integer()) {
    fail(key, fmt::format("\"{}\" must be a whole number", key));
  }
  const std::int64_t value = node->as_integer()->get();
  if (value < minimum || value > maximum) {
    fail(key, fmt::format("\"{}\" is {}; it must lie in {} .. {}", key, value, minimum, maximum));
  }
  return value;
}

std::optional<double> TomlSection::number(const std::string& key, double minimum, double maximum) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_number()) {
    fail(key, fmt::format("\"{}\" must be a number", key));
  }
  const double value = *node->value<double>();
  if (!(value >= minimum && value <= maximum)) {
    fail(key, fmt::format("\"{}\" is {}; it must lie in {} .. {}", key, value, minimum, maximum));
  }
  return value;
}

std::optional<base::SimDuration> TomlSection::duration(const std::string& key,
                                                       base::SimDuration minimum,
                                                       base::SimDuration maximum) {
  const std::optional<std::string> written = text(key);
  if (!written) {
    return std::nullopt;
  }
  const std::optional<base::SimDuration> value = parse_duration(*written);
  if (!value) {
    fail(key,
         fmt::format("\"{}\" is \"{}\"; write a number with its unit, e.g. \"1ms\", \"250us\", "
                     "\"2s\"",
                     key, *written));
  }
  if (*value < minimum || *value > maximum) {
    fail(key, fmt::format("\"{}\" is {}; it must lie in {} ns .. {} ns", key, *written,
                          minimum.nanoseconds(), maximum.nanoseconds()));
  }
  return value;
}

std::optional<std::vector<std::string>> TomlSection::texts(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  const toml::array* array = node->as_array();
  std::vector<std::string> values;
  if (array != nullptr) {
    for (const toml::node& element : *array) {
      if (const auto* value = element.as_string()) {
        values.push_back(value->get());
      }
    }
  }
  if (array == nullptr || values.size() != array->size()) {
    fail(key, fmt::format("\"{}\" must be a list of texts, e.g. [\"a\", \"b\"]", key));
  }
  return values;
}

std::optional<std::vector<std::int64_t>> TomlSection::integers(const std::string& key,
                                                               std::size_t count,
                                                               std::int64_t minimum,
                                                               std::int64_t maximum) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  const std::string expected = fmt::format(
      "\"{}\" must be a list of {} whole numbers from {} to {}", key, count, minimum, maximum);
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count) {
    fail(key, expected);
  }
  std::vector<std::int64_t> numbers;
  for (const toml::node& element : *array) {
    if (!element.is_integer() || element.as_integer()->get() < minimum ||
        element.as_integer()->get() > maximum) {
      fail(key, expected);
    }
    numbers.push_back(element.as_integer()->get());
  }
  return numbers;
}

std::optional<TomlSection> TomlSection::section(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_table()) {
    fail(key, fmt::format("\"{}\" must be a table, written [{}]", key, key));
  }
  return TomlSection(file_, fmt::format("[{}]", key), *node->as_table());
}

std::vector<TomlSection> TomlSection::sections(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return {};
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous<toml::table>()) {
    fail(key, fmt::format("\"{}\" must be written as [[{}]], once per {}", key, key, key));
  }
  std::vector<TomlSection> result;
  for (const toml::node& element : *array) {
    result.emplace_back(file_, fmt::format("[[{}]] number {}", key, result.size() + 1),
                        *element.as_table());
  }
  return result;
}

std::vector<std::string> TomlSection::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, node] : *table_) {
    keys.emplace_back(key.str());
  }
  return keys;
}

void TomlSection::finish() const {
  for (const auto& [key, node] : *table_) {
    const std::string name(key.str());
    if (asked_.contains(name)) {
      continue;
    }
    const std::string guess = closest_match(name, asked_);
    fail(name, fmt::format("unknown key \"{}\"{}; the keys are: {};", name,
                           guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                           joined(asked_)));
  }
}

}  // namespace stator::rack
