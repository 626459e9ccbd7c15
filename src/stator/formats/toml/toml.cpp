#include "stator/formats/toml/toml.hpp"

#include <utility>

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

namespace stator::formats {

namespace {

using settings::Value;

settings::Place place_of(const toml::node& node) {
  const toml::source_position begin = node.source().begin;
  return {begin.line, begin.column};
}

// Not deeper than toml++ parses, which refuses what is nested too deep.
Value value_of(const toml::node& node);

Value::Content content_of(const toml::node& node) {
  Value::Content content;
  if (const auto* table = node.as_table()) {
    settings::Table values;
    for (const auto& [key, each] : *table) {
      values.emplace(std::string(key.str()), value_of(each));
    }
    content = std::move(values);
  } else if (const auto* array = node.as_array()) {
    settings::List values;
    values.reserve(array->size());
    for (const toml::node& each : *array) {
      values.push_back(value_of(each));
    }
    content = std::move(values);
  } else if (const auto* text = node.as_string()) {
    content = text->get();
  } else if (const auto* boolean = node.as_boolean()) {
    content = boolean->get();
  } else if (const auto* whole = node.as_integer()) {
    content = whole->get();
  } else if (const auto* number = node.as_floating_point()) {
    content = number->get();
  }
  return content;
}

Value value_of(const toml::node& node) {
  return Value(content_of(node), place_of(node));
}

}  // namespace

base::Expected<Value, settings::Problem> parse_toml(std::string_view text,
                                                    const std::string& name) {
  try {
    return value_of(toml::parse(text, name));
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    return base::Unexpected{
        settings::Problem(name, place.line, place.column, "", std::string(error.description()))};
  }
}

Value::Content parse_toml_value(const std::string& text) {
  // One line only, so that no further key can come in with it.
  if (text.find('\n') == std::string::npos) {
    try {
      const toml::table table = toml::parse("value = " + text);
      return content_of(*table.get("value"));
    } catch (const toml::parse_error&) {  // a word
    }
  }
  return text;
}

}  // namespace stator::formats
