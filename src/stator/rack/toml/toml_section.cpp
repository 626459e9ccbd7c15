#include "stator/rack/toml/toml_section.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "stator/rack/toml/output_file.hpp"
#include "stator/rack/world/text.hpp"

namespace stator::rack {

namespace {

std::string joined(const std::set<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

/// As it is written in a rack file, with the largest unit that leaves a whole number.
std::string written(base::SimDuration duration) {
  const std::int64_t nanoseconds = duration.nanoseconds();
  if (nanoseconds % 1'000'000'000 == 0 && nanoseconds != 0) {
    return fmt::format("\"{}s\"", nanoseconds / 1'000'000'000);
  }
  if (nanoseconds % 1'000'000 == 0) {
    return fmt::format("\"{}ms\"", nanoseconds / 1'000'000);
  }
  if (nanoseconds % 1'000 == 0) {
    return fmt::format("\"{}us\"", nanoseconds / 1'000);
  }
  return fmt::format("\"{}ns\"", nanoseconds);
}

const toml::table& no_table() {
  static const toml::table table;
  return table;
}

}  // namespace

const toml::node* TomlSection::find(const TomlKey& key, ValueForm form) {
  asked_.insert(key.name);
  if (description_ != nullptr) {
    KeyDescription& entry = describe(key.name);
    if (std::ranges::find(entry.forms, form) == entry.forms.end()) {
      entry.forms.push_back(std::move(form));
    }
    if (!key.summary.empty() || !key.unit.empty()) {
      entry.summary = key.summary;
      entry.unit = key.unit;
    }
  }
  return table_->get(key.name);
}

bool TomlSection::is_text(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return answer(key, node != nullptr && node->is_string());
}

bool TomlSection::is_boolean(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return answer(key, node != nullptr && node->is_boolean());
}

bool TomlSection::is_table(const std::string& key) const {
  const toml::node* node = table_->get(key);
  return answer(key, node != nullptr && node->is_table());
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

void TomlSection::missing(const std::string& key, const std::string& explanation) {
  refuse_missing(key, explanation);
  throw RackFileError("");
}

void TomlSection::refuse_missing(const std::string& key, const std::string& explanation) {
  if (description_ != nullptr) {
    describe(key).required = true;
  }
  refuse(key, fmt::format("\"{}\" is missing; {}", key, explanation));
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

std::optional<std::string> TomlSection::text(const TomlKey& key) {
  return text_of(key, find(key, ValueKind::text));
}

std::optional<std::string> TomlSection::text_of(const TomlKey& key, const toml::node* node) {
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_string()) {
    refuse(key.name, fmt::format("\"{}\" must be a text in quotes", key.name));
    return std::nullopt;
  }
  return node->as_string()->get();
}

std::optional<std::string> TomlSection::choice(const TomlKey& key,
                                               const std::set<std::string>& choices) {
  ValueForm form{ValueKind::text};
  form.choices.assign(choices.begin(), choices.end());
  std::optional<std::string> value = text_of(key, find(key, std::move(form)));
  return value ? one_of(key, std::move(*value), choices) : std::nullopt;
}

std::optional<std::string> TomlSection::one_of(const TomlKey& key, std::string value,
                                               const std::set<std::string>& choices) {
  if (choices.contains(value)) {
    return value;
  }
  const std::string guess = closest_match(value, choices);
  refuse(key.name, fmt::format("\"{}\" is \"{}\"{}; it must be one of: {}", key.name, value,
                               guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess),
                               joined(choices)));
  return std::nullopt;
}

std::optional<std::vector<std::string>> TomlSection::choices(const TomlKey& key,
                                                             const std::set<std::string>& choices) {
  ValueForm form{ValueKind::texts, {}, {}, {}, 0};
  form.choices.assign(choices.begin(), choices.end());
  std::optional<std::vector<std::string>> values = texts_of(key, find(key, std::move(form)));
  if (!values) {
    return std::nullopt;
  }
  for (const std::string& value : *values) {
    if (!one_of(key, value, choices)) {
      return std::nullopt;
    }
  }
  return values;
}

std::optional<bool> TomlSection::boolean(const TomlKey& key) {
  const toml::node* node = find(key, ValueKind::boolean);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_boolean()) {
    refuse(key.name, fmt::format("\"{}\" must be true or false", key.name));
    return std::nullopt;
  }
  return node->as_boolean()->get();
}

std::optional<std::int64_t> TomlSection::integer(const TomlKey& key, std::int64_t minimum,
                                                 std::int64_t maximum) {
  const toml::node* node = find(
      key, ValueForm{ValueKind::integer, std::to_string(minimum), std::to_string(maximum), {}, 0});
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_integer()) {
    refuse(key.name, fmt::format("\"{}\" must be a whole number", key.name));
    return std::nullopt;
  }
  const std::int64_t value = node->as_integer()->get();
  if (value < minimum || value > maximum) {
    refuse(key.name,
           fmt::format("\"{}\" is {}; it must lie in {} .. {}", key.name, value, minimum, maximum));
    return std::nullopt;
  }
  return value;
}

std::optional<double> TomlSection::number(const TomlKey& key, double minimum, double maximum) {
  const toml::node* node = find(
      key,
      ValueForm{ValueKind::number, fmt::format("{}", minimum), fmt::format("{}", maximum), {}, 0});
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is_number()) {
    refuse(key.name, fmt::format("\"{}\" must be a number", key.name));
    return std::nullopt;
  }
  const double value = *node->value<double>();
  if (!(value >= minimum && value <= maximum)) {
    refuse(key.name,
           fmt::format("\"{}\" is {}; it must lie in {} .. {}", key.name, value, minimum, maximum));
    return std::nullopt;
  }
  return value;
}

std::optional<base::SimDuration> TomlSection::duration(const TomlKey& key,
                                                       base::SimDuration minimum,
                                                       base::SimDuration maximum) {
  const std::optional<std::string> text = text_of(
      key, find(key, ValueForm{ValueKind::duration, written(minimum), written(maximum), {}, 0}));
  if (!text) {
    return std::nullopt;
  }
  const std::optional<base::SimDuration> value = parse_duration(*text);
  if (!value) {
    refuse(key.name,
           fmt::format("\"{}\" is \"{}\"; write a number with its unit, e.g. \"1ms\", \"250us\", "
                       "\"2s\"",
                       key.name, *text));
    return std::nullopt;
  }
  if (*value < minimum || *value > maximum) {
    refuse(key.name, fmt::format("\"{}\" is {}; it must lie in {} ns .. {} ns", key.name, *text,
                                 minimum.nanoseconds(), maximum.nanoseconds()));
    return std::nullopt;
  }
  return value;
}

std::optional<std::vector<std::string>> TomlSection::texts(const TomlKey& key) {
  return texts_of(key, find(key, ValueKind::texts));
}

std::optional<std::vector<std::string>> TomlSection::texts_of(const TomlKey& key,
                                                              const toml::node* node) {
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
    refuse(key.name, fmt::format("\"{}\" must be a list of texts, e.g. [\"a\", \"b\"]", key.name));
    return std::nullopt;
  }
  return values;
}

std::optional<std::vector<std::int64_t>> TomlSection::integers(const TomlKey& key,
                                                               std::size_t count,
                                                               std::int64_t minimum,
                                                               std::int64_t maximum) {
  const toml::node* node = find(
      key,
      ValueForm{ValueKind::integers, std::to_string(minimum), std::to_string(maximum), {}, count});
  if (node == nullptr) {
    return std::nullopt;
  }
  const std::string expected = fmt::format(
      "\"{}\" must be a list of {} whole numbers from {} to {}", key.name, count, minimum, maximum);
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != count) {
    refuse(key.name, expected);
    return std::nullopt;
  }
  std::vector<std::int64_t> numbers;
  for (const toml::node& element : *array) {
    if (!element.is_integer() || element.as_integer()->get() < minimum ||
        element.as_integer()->get() > maximum) {
      refuse(key.name, expected);
      return std::nullopt;
    }
    numbers.push_back(element.as_integer()->get());
  }
  return numbers;
}

std::optional<TomlSection> TomlSection::section(const TomlKey& key) {
  const toml::node* node = find(key, ValueKind::table);
  if (node != nullptr && !node->is_table()) {
    refuse(key.name, fmt::format("\"{}\" must be a table, written [{}]", key.name, key.name));
    return std::nullopt;
  }
  if (node == nullptr && description_ == nullptr) {
    return std::nullopt;
  }
  return TomlSection(file_, fmt::format("[{}]", key.name),
                     node != nullptr ? *node->as_table() : no_table(), errors_,
                     description_below(key));
}

std::vector<TomlSection> TomlSection::sections(const TomlKey& key) {
  const toml::node* node = find(key, ValueKind::tables);
  std::vector<TomlSection> result;
  if (node == nullptr) {
    if (description_ != nullptr) {
      result.emplace_back(file_, fmt::format("[[{}]]", key.name), no_table(), errors_,
                          description_below(key));
    }
    return result;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous<toml::table>()) {
    refuse(key.name, fmt::format("\"{}\" must be written as [[{}]], once per {}", key.name,
                                 key.name, key.name));
    return {};
  }
  for (const toml::node& element : *array) {
    result.emplace_back(file_, fmt::format("[[{}]] number {}", key.name, result.size() + 1),
                        *element.as_table(), errors_, description_below(key));
  }
  return result;
}

void TomlSection::text(const TomlKey& key, std::string& target) {
  target = text(key).value_or(target);
  if (!target.empty()) {
    note_default(key, '"' + target + '"');
  }
}

void TomlSection::boolean(const TomlKey& key, bool& target) {
  target = boolean(key).value_or(target);
  note_default(key, target ? "true" : "false");
}

void TomlSection::number(const TomlKey& key, double minimum, double maximum, double& target) {
  target = number(key, minimum, maximum).value_or(target);
  if (target >= minimum && target <= maximum) {  // else: there is no such thing by default
    note_default(key, fmt::format("{}", target));
  }
}

void TomlSection::duration(const TomlKey& key, base::SimDuration minimum, base::SimDuration maximum,
                           base::SimDuration& target) {
  target = duration(key, minimum, maximum).value_or(target);
  note_default(key, written(target));
}

void TomlSection::texts(const TomlKey& key, std::vector<std::string>& target) {
  target = texts(key).value_or(target);
  note_default(key, target.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(target, "\", \"")));
}

std::string TomlSection::output(const TomlKey& key) {
  std::string path = text(key).value_or("");
  if (errors_ != nullptr && !path.empty()) {
    if (const std::string problem = output_problem(path); !problem.empty()) {
      refuse(key.name, problem);
    }
  }
  return path;
}

void TomlSection::claim(const std::string& key, const std::string& address) {
  if (errors_ != nullptr && !errors_->servers.insert(address).second) {
    refuse(key, fmt::format("\"{}\" is named twice in the rack; give each its own", address));
  }
}

std::vector<std::string> TomlSection::names() {
  if (description_ != nullptr) {
    description_->free_names = true;
    return {"NAME"};
  }
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
