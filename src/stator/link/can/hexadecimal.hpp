#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stator::link {

/// The number that `text` writes in hexadecimal digits of either case; nothing if it has another
/// character, none, or more than eight.
[[nodiscard]] constexpr std::optional<std::uint32_t> parse_hexadecimal(std::string_view text) {
  if (text.empty() || text.size() > 8) {
    return std::nullopt;
  }
  std::uint32_t number = 0;
  for (const char each : text) {
    std::uint32_t digit = 0;
    if (each >= '0' && each <= '9') {
      digit = static_cast<std::uint32_t>(each - '0');
    } else if (each >= 'A' && each <= 'F') {
      digit = static_cast<std::uint32_t>(each - 'A') + 10;
    } else if (each >= 'a' && each <= 'f') {
      digit = static_cast<std::uint32_t>(each - 'a') + 10;
    } else {
      return std::nullopt;
    }
    number = number << 4 | digit;
  }
  return number;
}

/// Appends `number` in `digits` upper-case digits.
inline void append_hexadecimal(std::string& out, std::uint32_t number, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  for (unsigned shift = 4 * digits; shift > 0;) {
    shift -= 4;
    out += kDigits[number >> shift & 0xF];
  }
}

}  // namespace stator::link
