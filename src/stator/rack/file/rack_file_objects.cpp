#include "stator/rack/file/rack_file_objects.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "stator/rack/sections/tmc8670_section.hpp"
#include "stator/rack/toml/rack_file_error.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

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

std::string name_of(const devices::tmc8670::ObjectValue& object) {
  return fmt::format("\"{:04X}:{:02X}\"", object.index, object.subindex);
}

std::string value_of(const devices::tmc8670::ObjectValue& object) {
  return fmt::format("{}", static_cast<std::int64_t>(object.bits));
}

std::vector<std::string> new_lines(const std::vector<const WrittenObject*>& objects,
                                   const std::string& indentation) {
  std::vector<std::string> result;
  result.reserve(objects.size());
  for (const WrittenObject* object : objects) {
    const std::string setting =
        fmt::format("{}{} = {}", indentation, name_of(object->object), value_of(object->object));
    result.push_back(
        object->meaning.empty() ? setting : fmt::format("{:<28} # {}", setting, object->meaning));
  }
  return result;
}

/// The entry of `table` for the object, in whichever way its key is written.
const toml::node* entry_of(const toml::table& table, const devices::tmc8670::ObjectValue& object) {
  for (const auto& [key, node] : table) {
    const std::optional<devices::tmc8670::ObjectValue> named = object_named(key.str());
    if (named && named->index == object.index && named->subindex == object.subindex) {
      return &node;
    }
  }
  return nullptr;
}

const toml::table& device_table(const toml::table& root, const DevicePlace& place,
                                const std::string& file) {
  const toml::table* device = root["segment"][place.segment]["device"][place.device].as_table();
  if (device == nullptr || device->is_inline()) {
    throw RackFileError(fmt::format(
        "{}: the device has no header [[segment.device]] of its own, behind which objects could be "
        "written; give it one",
        file));
  }
  return *device;
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
                   const std::vector<const WrittenObject*>& objects) {
  std::string& line = lines.at(table.source().end.line);
  const std::size_t brace = line.rfind('}', byte_of(line, table.source().end.column));
  std::size_t end = brace;
  while (end > 0 && line[end - 1] == ' ') {
    --end;
  }
  std::string added;
  for (const WrittenObject* object : objects) {
    const bool first = added.empty() && table.empty();
    added += fmt::format("{}{} = {}", first ? " " : ", ", name_of(object->object),
                         value_of(object->object));
  }
  line.replace(end, brace - end, added + " ");
}

}  // namespace

std::string with_objects(const std::string& text, const std::string& file, const DevicePlace& place,
                         std::span<const WrittenObject> objects) {
  toml::table root;
  try {
    root = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw RackFileError(
        fmt::format("{}:{}: {}", file, error.source().begin.line, error.description()));
  }
  const toml::table& device = device_table(root, place, file);
  const toml::table* there = device["objects"].as_table();
  std::vector<std::pair<toml::source_region, std::string>> changed;
  std::vector<const WrittenObject*> missing;
  for (const WrittenObject& object : objects) {
    const toml::node* entry = there != nullptr ? entry_of(*there, object.object) : nullptr;
    if (entry != nullptr) {
      changed.emplace_back(entry->source(), value_of(object.object));
    } else {
      missing.push_back(&object);
    }
  }
  Lines lines(text);
  const std::size_t behind = last_line(there != nullptr ? *there : device, lines);
  const std::string header = lines.at(device.source().begin.line);
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
    const std::size_t name = header.find("[[") + 2;
    added.insert(added.begin(), {"", fmt::format("{}[{}.objects]", indentation,
                                                 header.substr(name, header.find("]]") - name))});
  }
  lines.insert_behind(behind, added);
  return lines.text();
}

}  // namespace stator::rack
