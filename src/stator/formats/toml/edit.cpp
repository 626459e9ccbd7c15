#include "stator/formats/toml/edit.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#define TOML_HEADER_ONLY 0
#include <toml++/toml.h>

namespace stator::formats {

namespace {

/// The text as lines, which are changed from the last to the first so that places stay valid.
class Lines {
 public:
  explicit Lines(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      lines_.emplace_back(text.substr(0, end));
      text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    }
  }
  /// `line` counts from 1, as parsers do.
  [[nodiscard]] std::string& at(std::size_t line) { return lines_.at(line - 1); }
  void insert_behind(std::size_t line, const std::vector<std::string>& added) {
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(line), added.begin(), added.end());
  }
  [[nodiscard]] std::string text() const {
    std::string result;
    for (const std::string& line : lines_) {
      result += line;
      result += '\n';
    }
    return result;
  }

 private:
  std::vector<std::string> lines_;
};

/// Byte at which the column (characters from 1) of a line begins.
std::size_t byte_of(const std::string& line, std::size_t column) {
  constexpr unsigned kContinuation = 0x80;
  constexpr unsigned kMask = 0xC0;
  std::size_t byte = 0;
  for (std::size_t left = column - 1; byte < line.size() && left > 0; --left) {
    ++byte;
    while (byte < line.size() &&
           (static_cast<unsigned char>(line[byte]) & kMask) == kContinuation) {
      ++byte;
    }
  }
  return byte;
}

std::string_view without_indentation(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  return begin == std::string_view::npos ? std::string_view() : line.substr(begin);
}

/// Whether the table has a header of its own, "[...]".
bool has_header(const toml::node& node, Lines& lines) {
  return without_indentation(lines.at(node.source().begin.line)).starts_with('[') &&
         node.is_table() && !node.as_table()->is_inline();
}

/// The last line of what stands below a header itself, without the tables that follow.
std::size_t last_line(const toml::table& table, Lines& lines) {
  std::size_t last = table.source().begin.line;
  for (const auto& [key, node] : table) {
    const toml::array* array = node.as_array();
    const bool tables = array != nullptr && !array->empty() && array->is_array_of_tables() &&
                        has_header(*array->get(0), lines);
    if (tables || has_header(node, lines)) {
      continue;
    }
    const toml::table* dotted =
        node.is_table() && !node.as_table()->is_inline() ? node.as_table() : nullptr;
    last = std::max<std::size_t>(
        last, dotted != nullptr ? last_line(*dotted, lines) : node.source().end.line);
  }
  return last;
}

std::string setting_of(const TomlEntry& entry) {
  return fmt::format("\"{}\" = {}", entry.key, entry.value);
}

std::vector<std::string> new_lines(const std::vector<const TomlEntry*>& entries,
                                   const std::string& indentation) {
  std::vector<std::string> result;
  result.reserve(entries.size());
  for (const TomlEntry* entry : entries) {
    const std::string setting = indentation + setting_of(*entry);
    result.push_back(entry->comment.empty() ? setting
                                            : fmt::format("{:<28} # {}", setting, entry->comment));
  }
  return result;
}

/// The value in `table` for the key, in whichever way it is written there.
const toml::node* entry_of(const toml::table& table, std::string_view key,
                           const SameKey& same_key) {
  for (const auto& [written, node] : table) {
    if (same_key(written.str(), key)) {
      return &node;
    }
  }
  return nullptr;
}

/// Puts the new value over the old one of each entry. `entries` are in any order.
void replace_values(Lines& lines,
                    std::vector<std::pair<toml::source_region, std::string>> entries) {
  std::ranges::sort(entries, [](const auto& a, const auto& b) {
    const toml::source_position& left = a.first.begin;
    const toml::source_position& right = b.first.begin;
    return left.line != right.line ? left.line > right.line : left.column > right.column;
  });
  for (const auto& [region, value] : entries) {
    std::string& line = lines.at(region.begin.line);
    const std::size_t begin = byte_of(line, region.begin.column);
    line.replace(begin, byte_of(line, region.end.column) - begin, value);
  }
}

void append_inline(Lines& lines, const toml::table& table,
                   const std::vector<const TomlEntry*>& entries) {
  std::string& line = lines.at(table.source().end.line);
  const std::size_t brace = line.rfind('}', byte_of(line, table.source().end.column));
  std::size_t end = brace;
  while (end > 0 && line[end - 1] == ' ') {
    --end;
  }
  std::string added;
  for (const TomlEntry* entry : entries) {
    const bool first = added.empty() && table.empty();
    added += (first ? " " : ", ") + setting_of(*entry);
  }
  line.replace(end, brace - end, added + " ");
}

}  // namespace

base::Expected<std::string, settings::Problem> with_entries(
    const std::string& text, const std::string& file, const TomlPlace& place, std::string_view name,
    std::span<const TomlEntry> entries, const SameKey& same_key) {
  toml::table root;
  try {
    root = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    return base::Unexpected{settings::Problem(
        fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()))};
  }
  const toml::table* const around =
      root[place.outer][place.outer_number][place.inner][place.inner_number].as_table();
  if (around == nullptr || around->is_inline()) {
    return base::Unexpected{settings::Problem(
        fmt::format("{}: the {} has no header [[{}.{}]] of its own, behind which {} could be "
                    "written; give it one",
                    file, place.inner, place.outer, place.inner, name))};
  }
  const toml::table* there = (*around)[name].as_table();
  std::vector<std::pair<toml::source_region, std::string>> changed;
  std::vector<const TomlEntry*> missing;
  for (const TomlEntry& entry : entries) {
    const toml::node* value = there != nullptr ? entry_of(*there, entry.key, same_key) : nullptr;
    if (value != nullptr) {
      changed.emplace_back(value->source(), entry.value);
    } else {
      missing.push_back(&entry);
    }
  }
  Lines lines(text);
  const std::size_t behind = last_line(there != nullptr ? *there : *around, lines);
  const std::string header = lines.at(around->source().begin.line);
  const std::string& like = there != nullptr ? lines.at(behind) : header;
  const std::string indentation = like.substr(0, like.find_first_not_of(" \t"));
  if (there != nullptr && there->is_inline()) {
    if (!missing.empty()) {
      append_inline(lines, *there, missing);
    }
    replace_values(lines, std::move(changed));
    return lines.text();
  }
  replace_values(lines, std::move(changed));
  std::vector<std::string> added = new_lines(missing, indentation);
  if (there == nullptr) {
    const std::size_t begin = header.find("[[") + 2;
    const std::string path = header.substr(begin, header.find("]]") - begin);
    added.insert(added.begin(), {"", fmt::format("{}[{}.{}]", indentation, path, name)});
  }
  lines.insert_behind(behind, added);
  return lines.text();
}

}  // namespace stator::formats
