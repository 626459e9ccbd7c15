#include "stator/base/csv.hpp"

namespace stator::base {

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

}  // namespace stator::base
