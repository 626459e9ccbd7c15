#include "stator/base/led_pattern.hpp"

#include <array>
#include <cstddef>

namespace stator::base {

std::string_view to_text(LedPattern pattern) {
  constexpr std::array<std::string_view, 16> kNames{
      "off",        "single flash", "double flash", "triple flash", "quadruple flash",
      "5 flashes",  "6 flashes",    "7 flashes",    "8 flashes",    "9 flashes",
      "10 flashes", "11 flashes",   "12 flashes",   "blinking",     "flickering",
      "on"};
  const auto code = static_cast<std::size_t>(pattern);
  return code < kNames.size() ? kNames[code] : "?";
}

}  // namespace stator::base
