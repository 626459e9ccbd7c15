#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace stator::settings {

class Value;

/// Values by name. In the order of their names, so that what is found in a table does not depend on
/// who made it.
using Table = std::map<std::string, Value, std::less<>>;
using List = std::vector<Value>;

/// Where a value was written.
struct Place {
  std::uint32_t line = 0;    ///< from 1; 0: nowhere, a program made the value
  std::uint32_t column = 0;  ///< from 1, in characters
  /// What stands for the file, where that is not the one around the value; e.g. an option of a
  /// command. Null: it is that one.
  std::shared_ptr<const std::string> source{};
};

/// A configuration as it was written, before anybody knows what it configures: TOML, JSON and
/// programs make the same tree, and readers (Reader) know no other.
class Value {
 public:
  /// std::monostate: something that no key takes, as a date of TOML or a null of JSON.
  using Content =
      std::variant<std::monostate, bool, std::int64_t, double, std::string, List, Table>;

  // In value.cpp, since every user would compile the code for all alternatives.

  /// One that no key takes.
  Value();
  /// Of any type, as it was found at a place.
  explicit Value(Content content, Place place = {});
  // Implicit conversions, so that programs can write {{"kind", "motor-stall"}, {"axis", 1}} for a
  // table.

  /// A table.
  Value(Table table, Place place = {});  // NOLINT(google-explicit-constructor)
  /// A list.
  Value(List list, Place place = {});  // NOLINT(google-explicit-constructor)
  /// A text.
  Value(const char* text);  // NOLINT(google-explicit-constructor)
  /// A text.
  Value(std::string text);  // NOLINT(google-explicit-constructor)
  /// A truth value.
  Value(std::same_as<bool> auto value)  // NOLINT(google-explicit-constructor)
      : content_(value) {}
  /// A number.
  Value(std::floating_point auto number)  // NOLINT(google-explicit-constructor)
      : content_(double{number}) {}
  /// A whole number.
  template <std::integral Whole>
  requires(!std::same_as<Whole, bool>) Value(Whole number)  // NOLINT(google-explicit-constructor)
      : content_(static_cast<std::int64_t>(number)) {}
  Value(const Value& other);                 ///< copies the whole tree
  Value(Value&& other) noexcept;             ///< takes it
  Value& operator=(const Value& other);      ///< copies the whole tree
  Value& operator=(Value&& other) noexcept;  ///< takes it
  ~Value();

  /// The content if it is of that type, else null. Numbers are what they were written as: 1 is no
  /// double and 1.0 no std::int64_t.
  template <typename T>
  [[nodiscard]] const T* find() const {
    return std::get_if<T>(&content_);
  }
  /// The same of one that may be changed.
  template <typename T>
  [[nodiscard]] T* find() {
    return std::get_if<T>(&content_);
  }
  /// Whether the content is of that type.
  template <typename T>
  [[nodiscard]] bool is() const {
    return std::holds_alternative<T>(content_);
  }
  /// Of a table: what stands at `name`, or null; null as well if this is no table.
  [[nodiscard]] const Value* at(std::string_view name) const;
  /// A list that has tables only, e.g. of [[segment]]; an empty one is none.
  [[nodiscard]] bool is_list_of_tables() const;

  /// Where it was written.
  [[nodiscard]] const Place& place() const { return place_; }

 private:
  Content content_;
  Place place_;
};

}  // namespace stator::settings
