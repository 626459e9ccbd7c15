#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "stator/base/csv.hpp"

namespace stator::cli {

/// Prints one row of comma-separated values.
template <typename Columns>
void print_csv_row(const Columns& columns) {
  std::string row;
  bool first = true;
  for (const std::string_view column : columns) {
    if (!first) {
      row += ',';
    }
    first = false;
    base::append_csv_field(row, column);
  }
  fmt::print("{}\n", row);
}

/// `text` with the character that ends a cell of a Markdown table written so that it does not.
[[nodiscard]] std::string markdown_cell(std::string_view text);

/// The fields of one line of CSV, with quotes taken off; a field contains no line ends.
[[nodiscard]] std::vector<std::string> csv_fields(std::string_view line);

}  // namespace stator::cli
