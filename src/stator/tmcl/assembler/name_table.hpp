#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/base/spelling.hpp"
#include "stator/tmcl/assembler/expression.hpp"

namespace stator::tmcl {

/// Labels and constants of a program's text; the case of their letters does not count.
class NameTable {
 public:
  enum class Kind : std::uint8_t { label, constant };
  struct Entry {
    std::string_view name;  ///< in the text
    Kind kind = Kind::label;
    std::optional<std::int64_t> value;  ///< none after an error that has been told
    std::size_t line = 0;
  };

  /// Null if the name was free, else the entry that has it.
  const Entry* add(const Entry& entry);
  [[nodiscard]] const Entry* find(std::string_view name) const;
  [[nodiscard]] std::vector<std::string_view> names(bool labels_too) const;

 private:
  struct LessWithoutCase {
    bool operator()(std::string_view a, std::string_view b) const;
  };
  std::map<std::string_view, Entry, LessWithoutCase> entries_;
};

/// The names an operand may use.
class OperandScope final : public NameScope {
 public:
  /// `further_names` are suggested for a misspelled one, beside those of the table.
  OperandScope(const NameTable& table, bool labels,
               std::vector<std::string_view> further_names = {})
      : table_(table), labels_(labels), further_names_(std::move(further_names)) {}

  [[nodiscard]] base::Expected<std::int64_t, std::string> value_of(
      std::string_view name) const override;

 private:
  const NameTable& table_;
  bool labels_;
  std::vector<std::string_view> further_names_;
};

/// "; did you mean \"STOP\"?" when one of `known` is close to `word`, else nothing.
[[nodiscard]] std::string suggestion(std::string_view word,
                                     const std::vector<std::string_view>& known);

}  // namespace stator::tmcl
