#include "stator/settings/reader.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "stator/base/trigonometry.hpp"
#include "stator/settings/words.hpp"

namespace stator::settings {

namespace {

std::string quoted(base::SimDuration duration) {
  return fmt::format("\"{}\"", duration_text(duration));
}

const Value& no_table() {
  static const Value table{Table{}};
  return table;
}

}  // namespace

const Value* Reader::find(const KeyWords& key, ValueForm form) {
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
  return table_->at(key.name);
}

Problem Reader::problem_at(const std::string& key, const std::string& reason) const {
  const Value* const node = table_->at(key);
  const Place& place = node != nullptr ? node->place() : table_->place();
  const std::string& file = place.source != nullptr ? *place.source : reading_->file;
  if (file.empty()) {
    return Problem(reason);
  }
  return {file, place.line, place.column, key, fmt::format("{} in {}", reason, path_)};
}

void Reader::refuse_missing(const std::string& key, const std::string& explanation) {
  note_required(key);
  refuse(key, fmt::format("\"{}\" is missing; {}", key, explanation));
}

void Reader::refuse(const std::string& key, const std::string& reason) {
  refuse(key, problem_at(key, reason));
}

void Reader::refuse(const std::string& key, Problem problem) {
  if (refused_.insert(key).second) {
    problems().list.push_back(std::move(problem));
  }
}

std::optional<std::string> Reader::text(const KeyWords& key) {
  return text_of(key, find(key, ValueKind::text));
}

std::optional<std::string> Reader::text_of(const KeyWords& key, const Value* node) {
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is<std::string>()) {
    refuse(key.name, fmt::format("\"{}\" must be a text in quotes", key.name));
    return std::nullopt;
  }
  return *node->find<std::string>();
}

std::optional<std::string> Reader::choice(const KeyWords& key,
                                          const std::set<std::string>& choices) {
  ValueForm form{ValueKind::text};
  form.choices.assign(choices.begin(), choices.end());
  std::optional<std::string> value = text_of(key, find(key, std::move(form)));
  return value ? one_of(key, std::move(*value), choices) : std::nullopt;
}

std::optional<std::string> Reader::one_of(const KeyWords& key, std::string value,
                                          const std::set<std::string>& choices) {
  if (choices.contains(value)) {
    return value;
  }
  refuse(key.name, fmt::format(R"("{}" is "{}"{}; it must be one of: {})", key.name, value,
                               guess_text(value, choices), joined(choices)));
  return std::nullopt;
}

std::optional<std::vector<std::string>> Reader::choices(const KeyWords& key,
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

std::optional<bool> Reader::boolean(const KeyWords& key) {
  const Value* node = find(key, ValueKind::boolean);
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is<bool>()) {
    refuse(key.name, fmt::format("\"{}\" must be true or false", key.name));
    return std::nullopt;
  }
  return *node->find<bool>();
}

std::optional<std::int64_t> Reader::integer(const KeyWords& key, std::int64_t minimum,
                                            std::int64_t maximum) {
  const Value* node = find(
      key, ValueForm{ValueKind::integer, std::to_string(minimum), std::to_string(maximum), {}, 0});
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is<std::int64_t>()) {
    refuse(key.name, fmt::format("\"{}\" must be a whole number", key.name));
    return std::nullopt;
  }
  const std::int64_t value = *node->find<std::int64_t>();
  if (value < minimum || value > maximum) {
    refuse(key.name,
           fmt::format("\"{}\" is {}; it must lie in {} .. {}", key.name, value, minimum, maximum));
    return std::nullopt;
  }
  return value;
}

std::optional<double> Reader::number(const KeyWords& key, double minimum, double maximum) {
  const Value* node = find(
      key,
      ValueForm{ValueKind::number, fmt::format("{}", minimum), fmt::format("{}", maximum), {}, 0});
  if (node == nullptr) {
    return std::nullopt;
  }
  if (!node->is<double>() && !node->is<std::int64_t>()) {
    refuse(key.name, fmt::format("\"{}\" must be a number", key.name));
    return std::nullopt;
  }
  const auto* const whole = node->find<std::int64_t>();
  const double value = whole != nullptr ? static_cast<double>(*whole) : *node->find<double>();
  if (!(value >= minimum && value <= maximum)) {
    refuse(key.name,
           fmt::format("\"{}\" is {}; it must lie in {} .. {}", key.name, value, minimum, maximum));
    return std::nullopt;
  }
  return value;
}

std::optional<base::SimDuration> Reader::duration(const KeyWords& key, base::SimDuration minimum,
                                                  base::SimDuration maximum) {
  const std::optional<std::string> text = text_of(
      key, find(key, ValueForm{ValueKind::duration, quoted(minimum), quoted(maximum), {}, 0}));
  if (!text) {
    return std::nullopt;
  }
  const std::optional<base::SimDuration> value = parse_duration(*text);
  if (!value) {
    refuse(key.name,
           fmt::format(R"("{}" is "{}"; write a number with its unit, e.g. "1ms", "250us", "2s")",
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

std::optional<std::vector<std::string>> Reader::texts(const KeyWords& key) {
  return texts_of(key, find(key, ValueKind::texts));
}

std::optional<std::vector<std::string>> Reader::texts_of(const KeyWords& key, const Value* node) {
  if (node == nullptr) {
    return std::nullopt;
  }
  const List* const array = node->find<List>();
  std::vector<std::string> values;
  if (array != nullptr) {
    for (const Value& element : *array) {
      if (const auto* value = element.find<std::string>()) {
        values.push_back(*value);
      }
    }
  }
  if (array == nullptr || values.size() != array->size()) {
    refuse(key.name, fmt::format(R"("{}" must be a list of texts, e.g. ["a", "b"])", key.name));
    return std::nullopt;
  }
  return values;
}

std::optional<std::vector<std::int64_t>> Reader::integers(const KeyWords& key, std::size_t count,
                                                          std::int64_t minimum,
                                                          std::int64_t maximum) {
  const Value* node = find(
      key,
      ValueForm{ValueKind::integers, std::to_string(minimum), std::to_string(maximum), {}, count});
  if (node == nullptr) {
    return std::nullopt;
  }
  const std::string expected = fmt::format(
      "\"{}\" must be a list of {} whole numbers from {} to {}", key.name, count, minimum, maximum);
  const List* const array = node->find<List>();
  if (array == nullptr || array->size() != count) {
    refuse(key.name, expected);
    return std::nullopt;
  }
  std::vector<std::int64_t> numbers;
  for (const Value& element : *array) {
    const auto* const number = element.find<std::int64_t>();
    if (number == nullptr || *number < minimum || *number > maximum) {
      refuse(key.name, expected);
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Reader> Reader::section(const KeyWords& key) {
  const Value* node = find(key, ValueKind::table);
  if (node != nullptr && !node->is<Table>()) {
    refuse(key.name, fmt::format("\"{}\" must be a table, written [{}]", key.name, key.name));
    return std::nullopt;
  }
  if (node == nullptr && description_ == nullptr) {
    return std::nullopt;
  }
  return Reader(*reading_, fmt::format("[{}]", key.name), node != nullptr ? *node : no_table(),
                description_below(key));
}

std::vector<Reader> Reader::sections(const KeyWords& key) {
  const Value* node = find(key, ValueKind::tables);
  std::vector<Reader> result;
  if (node == nullptr) {
    if (description_ != nullptr) {
      result.emplace_back(*reading_, fmt::format("[[{}]]", key.name), no_table(),
                          description_below(key));
    }
    return result;
  }
  if (!node->is_list_of_tables()) {
    refuse(key.name, fmt::format("\"{}\" must be written as [[{}]], once per {}", key.name,
                                 key.name, key.name));
    return {};
  }
  for (const Value& element : *node->find<List>()) {
    result.emplace_back(*reading_, fmt::format("[[{}]] number {}", key.name, result.size() + 1),
                        element, description_below(key));
  }
  return result;
}

void Reader::text(const KeyWords& key, std::string& target) {
  target = text(key).value_or(target);
  if (!target.empty()) {
    note_default(key, '"' + target + '"');
  }
}

void Reader::boolean(const KeyWords& key, bool& target) {
  target = boolean(key).value_or(target);
  note_default(key, target ? "true" : "false");
}

void Reader::number(const KeyWords& key, double minimum, double maximum, double& target) {
  target = number(key, minimum, maximum).value_or(target);
  if (target >= minimum && target <= maximum) {  // else: there is no such thing by default
    note_default(key, fmt::format("{}", target));
  }
}

void Reader::degrees(const KeyWords& key, double minimum, double maximum, double& target) {
  constexpr double kDegree = base::kPi / 180.0;
  if (const auto value = number(key, minimum, maximum)) {
    target = *value * kDegree;
  }
  note_default(key, number_text(target / kDegree, 6));
}

void Reader::duration(const KeyWords& key, base::SimDuration minimum, base::SimDuration maximum,
                      base::SimDuration& target) {
  target = duration(key, minimum, maximum).value_or(target);
  note_default(key, quoted(target));
}

void Reader::texts(const KeyWords& key, std::vector<std::string>& target) {
  target = texts(key).value_or(target);
  note_default(key, target.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(target, "\", \"")));
}

std::string Reader::output(const KeyWords& key) {
  std::string path = text(key).value_or("");
  if (problems().everything && reading_->files != nullptr && !path.empty()) {
    if (const std::string problem = reading_->files->output_problem(path); !problem.empty()) {
      refuse(key.name, problem);
    }
  }
  return path;
}

std::optional<std::string> Reader::file_name(const KeyWords& key) {
  std::optional<std::string> name = text(key);
  if (name && reading_->named_files != nullptr) {
    reading_->named_files->push_back(*name);
  }
  return name;
}

std::optional<FileContent> Reader::file(const KeyWords& key, std::string_view what) {
  const std::optional<std::string> name = file_name(key);
  if (!name || reading_->files == nullptr) {
    return std::nullopt;
  }
  FileContent file{reading_->files->beside(reading_->file, *name), {}};
  auto content = reading_->files->content(file.path);
  if (!content) {
    refuse(key.name, fmt::format("cannot read the {} {}: {}; check the path and its permissions",
                                 what, file.path, content.error()));
    return std::nullopt;
  }
  file.content = std::move(*content);
  return file;
}

void Reader::claim(const std::string& key, const std::string& address) {
  if (problems().everything && !problems().servers.insert(address).second) {
    refuse(key, fmt::format("\"{}\" is named twice in the rack; give each its own", address));
  }
}

std::vector<std::string> Reader::names() {
  if (description_ != nullptr) {
    description_->free_names = true;
    return {"NAME"};
  }
  std::vector<std::string> keys;
  for (const auto& [key, value] : *table_->find<Table>()) {
    keys.push_back(key);
  }
  return keys;
}

void Reader::finish() {
  for (const auto& [name, value] : *table_->find<Table>()) {
    if (asked_.contains(name)) {
      continue;
    }
    refuse(name, fmt::format("unknown key \"{}\"{}; the keys are: {};", name,
                             guess_text(name, asked_), joined(asked_)));
  }
}

}  // namespace stator::settings
