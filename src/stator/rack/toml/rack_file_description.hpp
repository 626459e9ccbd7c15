#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "stator/product/catalogue/catalogue.hpp"

namespace stator::rack {

// What can stand in a rack file, as the functions that read one say it: they are run with sections
// that note what is asked. So there is one declaration of each key, the call that reads it.

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
  std::string minimum{};               ///< as written in a rack file; empty: no limit
  std::string maximum{};               ///< as written in a rack file; empty: no limit
  std::vector<std::string> choices{};  ///< of a text; empty: any
  std::size_t count = 0;               ///< of a list: so many elements

  friend bool operator==(const ValueForm&, const ValueForm&) = default;
};

struct TableDescription;

struct KeyDescription {
  std::string name;
  std::string summary;
  std::string unit;
  std::string default_value;  ///< as written in a rack file; empty: none
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
  /// Names are the user's; the only key stands for all of them.
  bool free_names = false;
  std::string selector;  ///< key whose value decides about further keys; empty: none
  std::vector<std::string> selector_choices;
  std::vector<TableVariant> variants;
  /// Keys of which the readers ask what form they have, with the answers they have been given.
  std::set<std::pair<std::string, bool>> forms_tried;

  /// The key, added if it is new.
  KeyDescription& key(const std::string& name);
  [[nodiscard]] const KeyDescription* find(const std::string& name) const;
  /// What applies with that value of the selector, added if it is new.
  TableDescription& variant(const std::string& value);
  /// A value of the selector of which not everything is known; the first one if there is none.
  [[nodiscard]] const std::string& unknown_variant() const;
  /// Nothing that readers ask for has been left untried, here and below.
  [[nodiscard]] bool complete() const;
};

/// All keys of a rack file of devices of `catalogue`.
[[nodiscard]] TableDescription describe_rack_file(const product::Catalogue& catalogue);

}  // namespace stator::rack
