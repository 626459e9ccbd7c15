#pragma once

#include <string>
#include <string_view>

namespace stator::base {

/// Appends `text` to a row of comma-separated values, quoted where it has to be (RFC 4180).
void append_csv_field(std::string& row, std::string_view text);

}  // namespace stator::base
