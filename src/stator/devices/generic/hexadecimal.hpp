// Indices as people write them.
#pragma once

#include <string>
#include <string_view>

namespace stator::devices::generic {

/// The lowest `digits` (1 to 8) of `value` in capitals.
[[nodiscard]] inline std::string hexadecimal(unsigned value, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text(digits, '0');
  for (unsigned i = 0; i < digits; ++i) {
    text[digits - 1 - i] = kDigits[(value >> (4 * i)) & 0xFU];
  }
  return text;
}

}  // namespace stator::devices::generic
