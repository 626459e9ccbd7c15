#include "cli/cells.hpp"

namespace stator::cli {

void append_csv_field(std::string& row, std::string_view text) {
  if (text.find_first_of(",\"\n") == std::string_view::npos) {
    row += text;
    return;
  }
  row += '"';
  for (const char c : text) {
    if (c == '"') {
      row += '"';
    }
    row += c;
  }
  row += '"';
}

std::string markdown_cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') {
      cell += '\\';
    }
    cell += c;
  }
  return cell;
}

}  // namespace stator::cli
