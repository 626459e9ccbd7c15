#pragma once

#include <cstdint>
#include <string_view>

namespace stator::base {

/// What a status LED shows. The codes are those of registers 0x0138 and 0x0139 of EtherCAT slave
/// controllers; ETG.1300 and CiA 303-3 give the patterns the same names and times.
enum class LedPattern : std::uint8_t {
  off = 0,
  single_flash = 1,
  double_flash = 2,
  triple_flash = 3,
  quadruple_flash = 4,  ///< 5 to 12: that many flashes
  blinking = 13,
  flickering = 14,
  on = 15,
};

/// "off", "single flash" to "quadruple flash", "5 flashes" to "12 flashes", "blinking",
/// "flickering", "on"; "?" for a code that is none.
[[nodiscard]] std::string_view to_text(LedPattern pattern);

}  // namespace stator::base
