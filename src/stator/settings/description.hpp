#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace stator::settings {

// What can stand in a configuration, as its readers say it: they are run with tables that note what
// is asked for (Reader). So there is one declaration of each key, from which it is read and
// described.

enum class ValueKind : std::uint8_t {
  text,
  boolean,
  integer,
  number,
  duration,
  texts,
  integers,
  table,
  tables,  ///< an array of tables
};

/// One form that a key's value may have; `bit_rate` is a whole number or a text.
struct ValueForm {
  ValueKind kind = ValueKind::text;
  std::string minimum{};               ///< as written in a file; empty: no limit
  std::string maximum{};               ///< as written in a file; empty: no limit
  std::vector<std::string> choices{};  ///< of a text; empty: any
  std::size_t count = 0;               ///< of a list: so many elements

  friend bool operator==(const ValueForm&, const ValueForm&) = default;
};

struct TableDescription;

struct KeyDescription {
  std::string name;
  std::string summary;
  std::string unit;
  std::string default_value;  ///< as written in a file; empty: none
  bool required = false;
  std::vector<ValueForm> forms;
  std::unique_ptr<TableDescription> table;  ///< of a table, or of each table of an array
};

/// What a table allows if its selector has a certain value.
struct TableVariant {
  std::string value;
  std::unique_ptr<TableDescription> table;  ///< further keys
};

/// The keys of one table.
struct TableDescription {
  std::deque<KeyDescription> keys;
  /// The keys are those of another kind of file, "rack-file", or of an array in it,
  /// "rack-file#fault": docs/rack-file-keys.md and docs/rack-file.schema.json have them. Empty:
  /// they stand here only.
  std::string kind_of_file;
  /// Names are the user's; the only key stands for all of them.
  bool free_names = false;
  std::string selector;  ///< key whose value decides about further keys; empty: none
  std::vector<std::string> selector_choices;
  std::vector<TableVariant> variants;

  /// The key, added if it is new.
  KeyDescription& key(const std::string& name);
  [[nodiscard]] const KeyDescription* find(const std::string& name) const;
  /// What applies with that value of the selector, added if it is new.
  TableDescription& variant(const std::string& value);
};

}  // namespace stator::settings
