#include "stator/formats/toml/toml.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

#include "stator/formats/nesting.hpp"

namespace stator::formats {

namespace {

using settings::Place;
using settings::Value;

Place place_of(const toml::node& node) {
  const toml::source_position begin = node.source().begin;
  return {begin.line, begin.column};
}

/// Of a character, counted from the text's beginning.
Place place_of(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
  const auto is_first_byte = [](char c) {
    constexpr unsigned kContinuation = 0x80;
    constexpr unsigned kMask = 0xC0;
    return (static_cast<unsigned char>(c) & kMask) != kContinuation;
  };
  return {static_cast<std::uint32_t>(1 + std::ranges::count(before, '\n')),
          static_cast<std::uint32_t>(
              1 + std::ranges::count_if(before.substr(line_begin), is_first_byte))};
}

// Not deeper than NestingScan lets pass.
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

/// Finds where a text nests too deep. The parser bounds lists and tables in braces, but each dot of
/// a key opens a table as well, and its own tables are destroyed by calls within calls.
class NestingScan {
 public:
  explicit NestingScan(std::string_view text) : text_(text) {}

  /// Where it is too deep, as characters from the text's beginning.
  [[nodiscard]] std::optional<std::size_t> run() {
    while (at_ < text_.size()) {
      const char character = text_[at_];
      if (character == '"' || character == '\'') {
        skip_text(character);
        begins_ = false;
        continue;
      }
      if (character == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
        continue;
      }
      take(character);
      if (outer_ + dots_ > kDeepestNesting) {
        return at_;
      }
      ++at_;
    }
    return std::nullopt;
  }

 private:
  /// What is around brackets.
  struct Around {
    std::size_t outer;
    std::size_t dots;
  };

  void take(char character) {
    switch (character) {
      case '\n':
        if (around_.empty()) {  // the end of a key with its value, or of a table's name
          table_ = in_name_ ? dots_ + 1 : table_;
          outer_ = table_;
          dots_ = 0;
          begins_ = true;
          in_name_ = false;
        }
        return;
      case ' ':
      case '\t':
      case '\r':
        return;
      case '.':
        ++dots_;
        break;
      case ',':
        dots_ = 0;
        break;
      case '[':
      case '{':
        if (begins_) {
          in_name_ = true;
          outer_ = 0;
          return;  // a second one is of the name, too
        }
        if (!in_name_) {
          around_.push_back({outer_, dots_});
          outer_ += dots_ + 1;
          dots_ = 0;
        }
        break;
      case ']':
      case '}':
        if (!around_.empty()) {
          outer_ = around_.back().outer;
          dots_ = around_.back().dots;
          around_.pop_back();
        }
        break;
      default:
        break;
    }
    begins_ = false;
  }

  /// To behind its end; a text of one line ends with it at the latest.
  void skip_text(char quote) {
    const bool long_text = text_.substr(at_).starts_with(std::string(3, quote));
    at_ += long_text ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\\' && quote == '"') {
        ++at_;
      } else if (long_text && text_.substr(at_).starts_with(std::string(3, quote))) {
        at_ += 3;
        for (int more = 0; more < 2 && at_ < text_.size() && text_[at_] == quote; ++more) {
          ++at_;  // quotes that are the text's own
        }
        return;
      } else if (!long_text && text_[at_] == quote) {
        ++at_;
        return;
      } else if (!long_text && text_[at_] == '\n') {
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Around> around_;
  std::size_t table_ = 0;  ///< how deep the table is whose keys follow
  std::size_t outer_ = 0;  ///< how deep it is around the key or the element of a list
  std::size_t dots_ = 0;
  bool begins_ = true;    ///< nothing but spaces since the line's beginning
  bool in_name_ = false;  ///< of a table
};

}  // namespace

base::Expected<Value, settings::Problem> parse_toml(std::string_view text,
                                                    const std::string& name) {
  if (const auto deep = NestingScan(text).run()) {
    const Place place = place_of(text, *deep);
    return base::Unexpected{
        settings::Problem(name, place.line, place.column, "", std::string(kNestedTooDeep))};
  }
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
  const std::string line = "value = " + text;
  if (text.find('\n') == std::string::npos && !NestingScan(line).run()) {
    try {
      const toml::table table = toml::parse(line);
      return content_of(*table.get("value"));
    } catch (const toml::parse_error&) {  // a word
    }
  }
  return text;
}

}  // namespace stator::formats
