#include "stator/settings/value_text.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <variant>

#include <fmt/format.h>

namespace stator::settings {

namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '"' || letter == '\\') {
      result += '\\';
      result += letter;
    } else if (code < 0x20U || code == 0x7FU) {
      result += fmt::format("\\u{:04X}", code);
    } else {
      result += letter;
    }
  }
  return result + '"';
}

/// A number with a point or an exponent, else it would be read as a whole one.
std::string number_text(double number) {
  if (std::isnan(number)) {
    return "nan";
  }
  if (std::isinf(number)) {
    return number < 0.0 ? "-inf" : "inf";
  }
  std::string text = fmt::format("{}", number);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

bool is_taken(const Value& value) {
  return !value.is<std::monostate>();
}

std::string text_of(const Value& value) {
  if (const auto* truth = value.find<bool>()) {
    return *truth ? "true" : "false";
  }
  if (const auto* whole = value.find<std::int64_t>()) {
    return std::to_string(*whole);
  }
  if (const auto* number = value.find<double>()) {
    return number_text(*number);
  }
  if (const auto* text = value.find<std::string>()) {
    return quoted(*text);
  }
  std::string inside;
  if (const auto* list = value.find<List>()) {
    for (const Value& each : *list) {
      if (is_taken(each)) {
        inside += (inside.empty() ? "" : ", ") + text_of(each);
      }
    }
    return "[" + inside + "]";
  }
  for (const auto& [name, each] : *value.find<Table>()) {
    if (is_taken(each)) {
      inside += fmt::format("{}{} = {}", inside.empty() ? "" : ", ", quoted(name), text_of(each));
    }
  }
  return "{" + inside + "}";
}

}  // namespace

std::string toml_text(const Table& table) {
  std::string lines;
  for (const auto& [name, value] : table) {
    if (is_taken(value)) {
      lines += fmt::format("{} = {}\n", quoted(name), text_of(value));
    }
  }
  return lines;
}

}  // namespace stator::settings
