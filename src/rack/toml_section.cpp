#include "rack/toml_section.hpp"

#include <utility>

#include <fmt/format.h>

#include "rack/output_file.hpp"
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

RackFileError TomlSection::error_at(const std::string& key, const std::string& reason) const {
  if (file_.empty()) {
    return RackFileError(reason);
  }
  const toml::node* node = table_->get(key);
  const toml::source_position place = (node != nullptr ? node->source() : table_->source()).begin;
  return {file_, place.line, place.column, key, fmt::format("{} in {}", reason, path_)};
}

// Nothing to tell: an error without text ends a table whose key has been refused already.
void TomlSection::collect(const RackFileError& error) {
  if (!std::string_view(error.what()).empty()) {
    errors_->list.push_back(error);
  }
}

void TomlSection::fail(const std::string& key, const std::string& reason) {
  if (errors_ != nullptr && !refused_.insert(key).second) {
    throw RackFileError("");
  }
  throw error_at(key, reason);
}

void TomlSection::fail_for_reference(const std::string& key, const std::string& reason) {
  if (errors_ != nullptr && errors_->devices_missing) {
    throw RackFileError("");
  }
  fail(key, reason);
}

void TomlSection::refuse(const std::string& key, const std::string& reason) {
  refuse(key, error_at(key, reason));
}

void TomlSection::refuse(const std::string& key, const RackFileError& error) {
  if (errors_ == nullptr) {
    throw error;
  }
  if (refused_.insert(key).second) {
    collect(error);
  }
}

std::optional<std::string> TomlSection::text(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_string()) {
    refuse(key, fmt::format("\"{}\" must be a text in quotes", key));
    return std::nullopt;
  }
  return node->as_string()->get();
}

std::optional<std::string> TomlSection::choice(const std::string& key,
                                               const std::set<std::string>& choices) {
  std::optional<std::string> value = text(key);
  if (value && !choices.contains(*value)) {
    const std::string guess = closest_match(*value, choices);
    refuse(key, fmt::format("\"{}\" is \"{}\"{}; it must be one of: {}", key, *value,
                            guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                            joined(choices)));
    return std::nullopt;
  }
  return value;
}

std::optional<bool> TomlSection::boolean(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_boolean()) {
    refuse(key, fmt::format("\"{}\" must be true or false", key));
    return std::nullopt;
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
    refuse(key, fmt::format("\"{}\" must be a whole number", key));
    return std::nullopt;
  }
  const std::int64_t value = node->as_integer()->get();
  if (value < minimum || value > maximum) {
    refuse(key, fmt::format("\"{}\" is {}; it must lie in {} .. {}", key, value, minimum, maximum));
    return std::nullopt;
  }
  return value;
}

std::optional<double> TomlSection::number(const std::string& key, double minimum, double maximum) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_number()) {
    refuse(key, fmt::format("\"{}\" must be a number", key));
    return std::nullopt;
  }
  const double value = *node->value<double>();
  if (!(value >= minimum && value <= maximum)) {
    refuse(key, fmt::format("\"{}\" is {}; it must lie in {} .. {}", key, value, minimum, maximum));
    return std::nullopt;
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
    refuse(key,
           fmt::format("\"{}\" is \"{}\"; write a number with its unit, e.g. \"1ms\", \"250us\", "
                       "\"2s\"",
                       key, *written));
    return std::nullopt;
  }
  if (*value < minimum || *value > maximum) {
    refuse(key, fmt::format("\"{}\" is {}; it must lie in {} ns .. {} ns", key, *written,
                            minimum.nanoseconds(), maximum.nanoseconds()));
    return std::nullopt;
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
    refuse(key, fmt::format("\"{}\" must be a list of texts, e.g. [\"a\", \"b\"]", key));
    return std::nullopt;
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
    refuse(key, expected);
    return std::nullopt;
  }
  std::vector<std::int64_t> numbers;
  for (const toml::node& element : *array) {
    if (!element.is_integer() || element.as_integer()->get() < minimum ||
        element.as_integer()->get() > maximum) {
      refuse(key, expected);
      return std::nullopt;
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
    refuse(key, fmt::format("\"{}\" must be a table, written [{}]", key, key));
    return std::nullopt;
  }
  return TomlSection(file_, fmt::format("[{}]", key), *node->as_table(), errors_);
}

std::vector<TomlSection> TomlSection::sections(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    return {};
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous<toml::table>()) {
    refuse(key, fmt::format("\"{}\" must be written as [[{}]], once per {}", key, key, key));
    return {};
  }
  std::vector<TomlSection> result;
  for (const toml::node& element : *array) {
    result.emplace_back(file_, fmt::format("[[{}]] number {}", key, result.size() + 1),
                        *element.as_table(), errors_);
  }
  return result;
}

std::string TomlSection::output(const std::string& key) {
  std::string path = text(key).value_or("");
  if (errors_ != nullptr && !path.empty()) {
    if (const std::string problem = output_problem(path); !problem.empty()) {
      refuse(key, problem);
    }
  }
  return path;
}

void TomlSection::claim(const std::string& key, const std::string& address) {
  if (errors_ != nullptr && !errors_->servers.insert(address).second) {
    refuse(key, fmt::format("\"{}\" is named twice in the rack; give each its own", address));
  }
}

std::vector<std::string> TomlSection::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, node] : *table_) {
    keys.emplace_back(key.str());
  }
  return keys;
}

void TomlSection::finish() {
  for (const auto& [key, node] : *table_) {
    const std::string name(key.str());
    if (asked_.contains(name)) {
      continue;
    }
    const std::string guess = closest_match(name, asked_);
    refuse(name, fmt::format("unknown key \"{}\"{}; the keys are: {};", name,
                             guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                             joined(asked_)));
  }
}

}  // namespace stator::rack
