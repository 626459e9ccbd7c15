#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>

namespace stator::devices::tmc8461 {

/// As it is written in a configuration file: 0x and at least `digits` digits, e.g. "0x1000".
[[nodiscard]] inline std::string hexadecimal(std::uint32_t number, std::size_t digits = 1) {
  std::array<char, 8> buffer{};
  const char* const end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), number, 16).ptr;
  const std::string text(static_cast<const char*>(buffer.data()), end);
  return "0x" + std::string(digits > text.size() ? digits - text.size() : 0, '0') + text;
}

}  // namespace stator::devices::tmc8461
