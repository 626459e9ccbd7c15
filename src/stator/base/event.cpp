#include "stator/base/event.hpp"

#include <charconv>

namespace stator::base {

namespace {

std::string to_hexadecimal(std::int64_t number, int digits) {
  std::string text;
  auto rest = static_cast<std::uint64_t>(number);
  while (rest != 0 || static_cast<int>(text.size()) < digits) {
    text.insert(text.begin(), "0123456789ABCDEF"[rest & 0xF]);
    rest >>= 4;
  }
  return text + "h";
}

/// `number` counts 10^-places: 1500 with three places is "1.500".
std::string to_decimal(std::int64_t number, int places) {
  std::string text = std::to_string(number < 0 ? -number : number);
  while (static_cast<int>(text.size()) <= places) {
    text.insert(text.begin(), '0');
  }
  text.insert(text.end() - places, '.');
  return number < 0 ? "-" + text : text;
}

/// "-1, 0, 3, 6 .. 10": three or more in a row are told by the first and the last.
std::string to_plain_text(std::span<const std::int64_t> list) {
  constexpr std::size_t kShortestRow = 3;
  std::string text;
  while (!list.empty()) {
    std::size_t row = 1;
    while (row < list.size() && list[row] == list[row - 1] + 1) {
      ++row;
    }
    const bool told_by_ends = row >= kShortestRow;
    text += (text.empty() ? "" : ", ") + std::to_string(list.front());
    if (told_by_ends) {
      text += " .. " + std::to_string(list[row - 1]);
    }
    list = list.subspan(told_by_ends ? row : 1);
  }
  return text;
}

/// What "{0}" stands for.
std::string to_plain_text(const EventArgument& argument) {
  if (argument.is_list()) {
    return to_plain_text(argument.list());
  }
  return argument.is_text() ? std::string(argument.text()) : std::to_string(argument.number());
}

/// Appends the argument that `placeholder` (the text between the braces) names; false if none.
bool append_argument(std::string& sentence, std::string_view placeholder, const Event& event) {
  std::size_t position = 0;
  const char* const end = placeholder.data() + placeholder.size();
  const auto number = std::from_chars(placeholder.data(), end, position);
  if (number.ec != std::errc() || position >= event.arguments.size()) {
    return false;
  }
  const EventArgument& argument = event.arguments[position];
  if (number.ptr == end) {
    sentence += to_plain_text(argument);
    return true;
  }
  int digits = 1;
  const std::string_view format(number.ptr, static_cast<std::size_t>(end - number.ptr));
  const bool hexadecimal = format.starts_with(":x");
  if (!argument.is_number() || !(hexadecimal || format.starts_with(":d")) ||
      std::from_chars(format.data() + 2, end, digits).ptr != end) {
    return false;
  }
  sentence += hexadecimal ? to_hexadecimal(argument.number(), digits)
                          : to_decimal(argument.number(), digits);
  return true;
}

}  // namespace

std::string to_sentence(const Event& event) {
  if (event.rule == nullptr) {
    return "event without a rule";
  }
  std::string sentence;
  std::string_view rest = event.rule->text;
  while (!rest.empty()) {
    const std::size_t open = rest.find('{');
    const std::size_t close = rest.find('}', open == std::string_view::npos ? rest.size() : open);
    if (close == std::string_view::npos) {
      break;
    }
    sentence += rest.substr(0, open);
    if (!append_argument(sentence, rest.substr(open + 1, close - open - 1), event)) {
      sentence += rest.substr(open, close - open + 1);
    }
    rest.remove_prefix(close + 1);
  }
  sentence += rest;
  return sentence;
}

}  // namespace stator::base
