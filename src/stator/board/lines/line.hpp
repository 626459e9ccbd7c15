#pragma once

#include <cstdint>

namespace stator::board {

/// Number of an I/O pin of the chip: 0..15 are MFCIO00..15, 16..23 the high-voltage pins
/// MFC_HV0..7 (mfc_pins.csv).
using Line = std::uint8_t;
inline constexpr Line kLines = 24;
/// A pin of a peripheral that is wired to nothing.
inline constexpr Line kNotWired = 0xFF;

/// What one end of a line does to it.
enum class Drive : std::uint8_t { released, low, high };

[[nodiscard]] constexpr Drive driven(bool level) {
  return level ? Drive::high : Drive::low;
}

/// What two ends of a line make together. Low wins over high: open-drain lines need it, and two
/// push-pull outputs against each other end near ground with usual transistors.
[[nodiscard]] constexpr Drive together(Drive a, Drive b) {
  if (a == Drive::low || b == Drive::low) {
    return Drive::low;
  }
  return a == Drive::high || b == Drive::high ? Drive::high : Drive::released;
}

}  // namespace stator::board
