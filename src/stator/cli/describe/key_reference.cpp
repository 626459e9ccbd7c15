#include "stator/cli/describe/key_reference.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/cells.hpp"
#include "stator/formats/json/schema.hpp"

namespace stator::cli {

namespace {

using settings::KeyDescription;
using settings::TableDescription;
using settings::TableVariant;
using settings::ValueKind;

/// A table that has a heading of its own.
struct Chapter {
  std::string path;  ///< "segment.device"
  bool is_array = false;
  const settings::TableDescription* table = nullptr;
};

/// More words than these are told by the first and the last one.
constexpr std::size_t kLongList = 12;

bool any_integer(const settings::ValueForm& form) {
  return form.kind == settings::ValueKind::integer &&
         form.minimum == std::to_string(std::numeric_limits<std::int64_t>::min());
}

std::string choices_of(const settings::ValueForm& form) {
  if (form.choices.size() > kLongList) {
    return fmt::format("`\"{}\"` … `\"{}\"`", form.choices.front(), form.choices.back());
  }
  return fmt::format("`\"{}\"`", fmt::join(form.choices, "\"`, `\""));
}

std::string range(const settings::ValueForm& form, const std::string& unit) {
  return fmt::format("{} to {}{}{}", form.minimum, form.maximum, unit.empty() ? "" : " ", unit);
}

std::string text_of(const settings::ValueForm& form, const std::string& unit) {
  switch (form.kind) {
    case settings::ValueKind::text:
      return form.choices.empty() ? "text" : choices_of(form);
    case settings::ValueKind::boolean:
      return "`true`, `false`";
    case settings::ValueKind::integer:
      return any_integer(form) ? "integer" : "integer, " + range(form, unit);
    case settings::ValueKind::number:
      return range(form, unit);
    case settings::ValueKind::duration:
      return "duration, " + range(form, "");
    case settings::ValueKind::texts:
      return form.choices.empty() ? "list of texts" : "list of names";
    case settings::ValueKind::integers:
      return fmt::format("list of {} integers, {}", form.count, range(form, unit));
    case settings::ValueKind::table:
      return "table";
    case settings::ValueKind::tables:
      return "tables";
  }
  return {};
}

std::string values_of(const settings::KeyDescription& key) {
  std::string values;
  for (const settings::ValueForm& form : key.forms) {
    values += (values.empty() ? "" : " or ") + text_of(form, key.unit);
  }
  return values;
}

std::string default_of(const settings::KeyDescription& key) {
  if (key.required) {
    return "needed";
  }
  return key.default_value.empty() ? "" : fmt::format("`{}`", key.default_value);
}

/// With a link to keys that stand on another page.
std::string linked_values_of(const settings::KeyDescription& key) {
  std::string page = key.table != nullptr ? key.table->kind_of_file : "";
  if (page.empty()) {
    return values_of(key);
  }
  page.insert(std::min(page.find('#'), page.size()), "-keys.md");
  return fmt::format("{} ([keys]({}))", values_of(key), page);
}

/// A table whose keys are written with a dot: it has neither variants nor names of the user's.
bool is_plain(const settings::KeyDescription& key) {
  return key.forms.size() == 1 && key.forms.front().kind == settings::ValueKind::table &&
         !key.table->free_names && key.table->selector.empty() && key.table->kind_of_file.empty();
}

std::string rows_of(const settings::TableDescription& table, const std::string& prefix,
                    const std::string& path, std::vector<Chapter>& chapters) {
  std::string rows;
  for (const settings::KeyDescription& key : table.keys) {
    const std::string name = prefix + key.name;
    if (is_plain(key)) {
      rows += rows_of(*key.table, name + ".", path, chapters);
      continue;
    }
    if (key.table != nullptr && key.table->kind_of_file.empty()) {
      const std::string below = path.empty() ? name : fmt::format("{}.{}", path, name);
      const bool is_array = key.forms.front().kind == settings::ValueKind::tables;
      chapters.push_back({below, is_array, key.table.get()});
    }
    rows += fmt::format("| `{}` | {} | {} | {} |\n", name, markdown_cell(linked_values_of(key)),
                        markdown_cell(default_of(key)), markdown_cell(key.summary));
  }
  return rows;
}

std::string table_of(const std::string& rows) {
  return rows.empty() ? "" : "\n| Key | Values | Default | Meaning |\n|---|---|---|---|\n" + rows;
}

/// Writes chapter after chapter.
class Reference {
 public:
  void add(const Chapter& chapter);
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add_variants(const settings::TableDescription& table, const Chapter& chapter,
                    const std::string& name);

  std::string text_;
  std::map<std::string, std::string> tables_;  ///< rows that have been written, and below what
};

void Reference::add(const Chapter& chapter) {
  const settings::TableDescription& table = *chapter.table;
  if (table.free_names && table.keys.front().table != nullptr) {
    const settings::KeyDescription& any = table.keys.front();
    add({chapter.path + "." + any.name, false, any.table.get()});
    return;
  }
  const std::string name = chapter.path.empty() ? "Top level"
                           : chapter.is_array   ? fmt::format("`[[{}]]`", chapter.path)
                                                : fmt::format("`[{}]`", chapter.path);
  std::vector<Chapter> below;
  text_ += fmt::format("\n## {}\n", name);
  text_ += table_of(rows_of(table, "", chapter.path, below));
  add_variants(table, chapter, name);
  for (const Chapter& each : below) {
    add(each);
  }
}

/// Variants with the same keys share a table.
void Reference::add_variants(const settings::TableDescription& table, const Chapter& chapter,
                             const std::string& name) {
  struct Group {
    std::string values;
    std::string rows;
    std::vector<Chapter> below;
  };
  std::vector<Group> groups;
  for (const settings::TableVariant& variant : table.variants) {
    std::vector<Chapter> below;
    std::string rows = rows_of(*variant.table, "", chapter.path, below);
    const std::string value = fmt::format("\"{}\"", variant.value);
    const auto same = std::ranges::find(groups, rows, &Group::rows);
    if (same != groups.end() && below.empty()) {
      same->values += ", " + value;
    } else if (!rows.empty()) {
      groups.push_back({value, std::move(rows), std::move(below)});
    }
  }
  for (const Group& group : groups) {
    const std::string title = fmt::format("{} with `{} = {}`", name, table.selector, group.values);
    text_ += fmt::format("\n### {}\n", title);
    const auto [place, is_new] = tables_.try_emplace(group.rows, title);
    text_ += is_new ? table_of(group.rows) : fmt::format("\nThe keys of {}.\n", place->second);
    for (const Chapter& each : group.below) {
      if (is_new) {
        add(each);
      }
    }
  }
}

/// Keys of variants are told once each, whatever the value of the selector.
void add_paths(const TableDescription& table, const std::string& prefix,
               std::set<std::string>& listed, std::string& lines) {
  for (const KeyDescription& key : table.keys) {
    const std::string path = prefix + key.name;
    if (key.table == nullptr || key.forms.size() > 1) {
      const std::string line =
          fmt::format("{}\t{}\t{}\t{}\n", path, values_of(key), default_of(key), key.summary);
      if (listed.insert(line).second) {
        lines += line;
      }
    }
    if (key.table != nullptr) {
      const bool is_array = key.forms.front().kind == ValueKind::tables;
      add_paths(*key.table, path + (is_array ? "[]." : "."), listed, lines);
    }
  }
  for (const TableVariant& variant : table.variants) {
    add_paths(*variant.table, prefix, listed, lines);
  }
}

}  // namespace

std::string key_paths(const settings::TableDescription& file) {
  std::set<std::string> listed;
  std::string lines;
  add_paths(file, "", listed, lines);
  return lines;
}

std::string key_reference(const settings::TableDescription& file, std::string_view head) {
  Reference reference;
  reference.add({"", false, &file});
  return std::string(head) + reference.text();
}

void KeyOptions::add(CLI::App& command, CLI::Option* file, const FileKind& kind) {
  kind_ = &kind;
  CLI::Option* schema =
      command
          .add_flag("--schema", schema_,
                    fmt::format("Print the JSON schema of {}, for editors that check and complete",
                                kind.plural))
          ->excludes(file);
  command
      .add_flag("--reference", reference_,
                fmt::format("Print all keys of {} with values, defaults and meaning, in Markdown",
                            kind.plural))
      ->excludes(file)
      ->excludes(schema);
  command
      .add_flag("--keys", keys_,
                "Print one line per key for completion: path, values, default, meaning, with tabs")
      ->excludes(file)
      ->excludes(schema);
}

bool KeyOptions::print(const product::Catalogue& catalogue) const {
  if (!schema_ && !reference_ && !keys_) {
    return false;
  }
  const settings::TableDescription file = kind_->describe(catalogue);
  fmt::print("{}", schema_      ? formats::json_schema(file, kind_->title, std::string(kind_->name))
                   : reference_ ? key_reference(file, kind_->head)
                                : key_paths(file));
  return true;
}

}  // namespace stator::cli
