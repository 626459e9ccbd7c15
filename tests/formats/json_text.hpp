#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "stator/settings/value.hpp"

namespace stator::tests {

/// A text of JSON in quotes.
inline std::string json_string(std::string_view text) {
  std::string written = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      written += '\\';
      written += c;
    } else if (static_cast<unsigned char>(c) < 0x20U) {
      written += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      written += c;
    }
  }
  return written + '"';
}

/// A tree as JSON, whole numbers and doubles as they are; what JSON does not have is null.
inline std::string json_text(const settings::Value& value) {
  std::string text;
  if (const auto* const table = value.find<settings::Table>()) {
    for (const auto& [name, each] : *table) {
      text += text.empty() ? "{" : ",\n ";
      text += json_string(name) + ": " + json_text(each);
    }
    return text.empty() ? "{}" : text + "}";
  }
  if (const auto* const list = value.find<settings::List>()) {
    for (const settings::Value& each : *list) {
      text += text.empty() ? "[" : ", ";
      text += json_text(each);
    }
    return text.empty() ? "[]" : text + "]";
  }
  if (const auto* const words = value.find<std::string>()) {
    return json_string(*words);
  }
  if (const auto* const truth = value.find<bool>()) {
    return *truth ? "true" : "false";
  }
  if (const auto* const whole = value.find<std::int64_t>()) {
    return fmt::format("{}", *whole);
  }
  if (const auto* const number = value.find<double>();
      number != nullptr && std::isfinite(*number)) {
    text = fmt::format("{}", *number);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
  }
  return "null";
}

/// Whether both are the same wherever they were written. No number is equal to NaN.
inline bool same_tree(const settings::Value& a, const settings::Value& b) {
  if (const auto* const table = a.find<settings::Table>()) {
    const auto* const other = b.find<settings::Table>();
    if (other == nullptr || other->size() != table->size()) {
      return false;
    }
    for (const auto& [name, each] : *table) {
      const settings::Value* const there = b.at(name);
      if (there == nullptr || !same_tree(each, *there)) {
        return false;
      }
    }
    return true;
  }
  if (const auto* const list = a.find<settings::List>()) {
    const auto* const other = b.find<settings::List>();
    if (other == nullptr || other->size() != list->size()) {
      return false;
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (!same_tree((*list)[i], (*other)[i])) {
        return false;
      }
    }
    return true;
  }
  const auto same = [&]<typename T>(const T* mine) {
    const T* const theirs = b.find<T>();
    return mine != nullptr && theirs != nullptr && *mine == *theirs;
  };
  return (a.is<std::monostate>() && b.is<std::monostate>()) || same(a.find<bool>()) ||
         same(a.find<std::int64_t>()) || same(a.find<double>()) || same(a.find<std::string>());
}

}  // namespace stator::tests
