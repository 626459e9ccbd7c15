#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stator::tests {

using CsvRow = std::vector<std::string>;

/// Reads comma-separated values as RFC 4180 defines them: quoted fields may hold commas, line
/// breaks and doubled quotes; lines end with LF or CR LF.
inline std::vector<CsvRow> parse_csv(std::string_view text) {
  std::vector<CsvRow> rows;
  CsvRow row;
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    // What means nothing comes as a whole: tests read thousands of lines before they begin.
    const std::size_t end = std::min(text.find_first_of(quoted ? "\"" : "\",\n\r", i), text.size());
    field += text.substr(i, end - i);
    if (end == text.size()) {
      break;
    }
    i = end;
    const char c = text[i];
    if (quoted) {
      if (i + 1 < text.size() && text[i + 1] == '"') {
        field += '"';
        ++i;
      } else {
        quoted = false;
      }
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',' || c == '\n') {
      row.push_back(std::move(field));
      field.clear();
      if (c == '\n') {
        rows.push_back(std::move(row));
        row.clear();
      }
    }
  }
  if (!field.empty() || !row.empty()) {
    row.push_back(std::move(field));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace stator::tests
