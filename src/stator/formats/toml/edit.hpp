#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/settings/problem.hpp"

namespace stator::formats {

/// A key with its value, both as TOML writes them, and a few words that are written behind it where
/// it is new.
struct TomlEntry {
  std::string key;  ///< without quotes, which it gets
  std::string value;
  std::string comment{};
};

/// A table of an array of tables that stands in one of another such array, e.g. number 1 of
/// [[segment.device]] in number 0 of [[segment]].
struct TomlPlace {
  std::string_view outer;
  std::size_t outer_number = 0;  ///< from 0
  std::string_view inner;
  std::size_t inner_number = 0;  ///< from 0, within the outer one
};

/// Whether two keys mean the same; keys of objects can be written in several ways.
using SameKey = std::function<bool(std::string_view, std::string_view)>;

/// The text of a file in which the table `name` below the one at `place` has the given entries:
/// those there are get the new value in their place, the others follow; comments and layout stay. A
/// problem if the text is no TOML or the table at `place` stands within an inline array. `file`
/// stands for the file in it.
[[nodiscard]] base::Expected<std::string, settings::Problem> with_entries(
    const std::string& text, const std::string& file, const TomlPlace& place, std::string_view name,
    std::span<const TomlEntry> entries, const SameKey& same_key);

}  // namespace stator::formats
