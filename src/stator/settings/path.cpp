#include "stator/settings/path.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

namespace stator::settings {

namespace {

constexpr std::size_t kLongestList = 1000;
/// Each step is a table or list in another one; trees are destroyed by calls within calls.
constexpr std::ptrdiff_t kLongestPath = 256;

bool is_plain(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

/// Takes a name from the front of `rest`, in quotes or not; empty if there is none.
std::string take_name(std::string_view& rest) {
  std::string name;
  if (rest.starts_with('"')) {
    const std::size_t end = rest.find('"', 1);
    if (end != std::string_view::npos) {
      name = rest.substr(1, end - 1);
      rest.remove_prefix(end + 1);
    }
    return name;
  }
  while (!rest.empty() && is_plain(rest.front())) {
    name += rest.front();
    rest.remove_prefix(1);
  }
  return name;
}

}  // namespace

base::Expected<Path, std::string> parse_path(std::string_view text) {
  const auto steps = std::ranges::count_if(text, [](char c) { return c == '.' || c == '['; });
  if (steps >= kLongestPath) {
    return base::Unexpected{
        fmt::format("the path has {} steps; no key is more than {} deep, see "
                    "docs/rack-file-keys.md",
                    steps + 1, kLongestPath)};
  }
  Path path;
  std::string_view rest = text;
  const auto wrong = [&](std::string_view expected) {
    return base::Unexpected{
        fmt::format("\"{}\" is no path: {} is expected {}; write it like axis[1].load.inertia",
                    text, expected, rest.empty() ? "at its end" : fmt::format("at \"{}\"", rest))};
  };
  for (;;) {
    std::string name = take_name(rest);
    if (name.empty()) {
      return wrong("a name");
    }
    path.emplace_back(std::move(name));
    while (rest.starts_with('[')) {
      std::size_t number = 0;
      const char* const end = rest.data() + rest.size();
      const auto [behind, error] = std::from_chars(rest.data() + 1, end, number);
      if (error != std::errc() || behind == end || *behind != ']') {
        return wrong("a number in brackets");
      }
      path.emplace_back(number);
      rest.remove_prefix(static_cast<std::size_t>(behind - rest.data()) + 1);
    }
    if (rest.empty()) {
      return path;
    }
    if (!rest.starts_with('.')) {
      return wrong("a dot");
    }
    rest.remove_prefix(1);
  }
}

const Value* find(const Value& root, std::span<const PathStep> path) {
  const Value* value = &root;
  for (const PathStep& step : path) {
    if (const auto* const name = std::get_if<std::string>(&step)) {
      value = value->at(*name);
    } else {
      const auto* const list = value->find<List>();
      const std::size_t number = std::get<std::size_t>(step);
      value = list != nullptr && number < list->size() ? &(*list)[number] : nullptr;
    }
    if (value == nullptr) {
      return nullptr;
    }
  }
  return value;
}

base::Expected<void, std::string> set(Value& root, std::span<const PathStep> path, Value value) {
  const Place place = value.place();
  Value* target = &root;
  std::string passed;
  for (const PathStep& step : path) {
    if (const auto* const name = std::get_if<std::string>(&step)) {
      if (target->is<std::monostate>()) {
        *target = Value(Table{}, place);
      }
      auto* const table = target->find<Table>();
      if (table == nullptr) {
        return base::Unexpected{
            fmt::format(R"("{}" is no table, so it has no "{}")", passed, *name)};
      }
      target = &(*table)[*name];
      passed += (passed.empty() ? "" : ".") + *name;
      continue;
    }
    const std::size_t number = std::get<std::size_t>(step);
    if (target->is<std::monostate>()) {
      *target = Value(List{}, place);
    }
    auto* const list = target->find<List>();
    if (list == nullptr) {
      return base::Unexpected{fmt::format("\"{}\" is no list, so it has no [{}]", passed, number)};
    }
    if (number >= kLongestList) {
      return base::Unexpected{
          fmt::format("\"{}\" has no [{}]; a list has at most {}", passed, number, kLongestList)};
    }
    while (list->size() <= number) {
      list->emplace_back(Table{}, place);
    }
    target = &(*list)[number];
    passed += fmt::format("[{}]", number);
  }
  *target = std::move(value);
  return {};
}

}  // namespace stator::settings
