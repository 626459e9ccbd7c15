#pragma once

#include <cstdint>

namespace stator::control::foc {

// Integer arithmetic of the FOC block. Words of 16 bits are kept in int32_t, so that a value can be
// formed before it is cut.

inline constexpr std::int32_t kS16Min = -32768;
inline constexpr std::int32_t kS16Max = 32767;
inline constexpr std::int64_t kS32Min = INT32_MIN;
inline constexpr std::int64_t kS32Max = INT32_MAX;

/// value, cut to low..high. A branch that is rarely taken instead of a choice, so that what follows
/// need not wait for the comparison: these limits lie in a chain that is as long as the period's
/// whole computation.
[[nodiscard]] constexpr std::int64_t cut(std::int64_t value, std::int64_t low, std::int64_t high) {
  if (value < low) [[unlikely]] {
    return low;
  }
  if (value > high) [[unlikely]] {
    return high;
  }
  return value;
}

[[nodiscard]] constexpr std::int32_t saturate_s16(std::int64_t value) {
  const auto word = static_cast<std::int16_t>(value);
  if (word != value) [[unlikely]] {
    return static_cast<std::int32_t>(value < 0 ? kS16Min : kS16Max);
  }
  return word;
}

[[nodiscard]] constexpr std::int32_t saturate_s32(std::int64_t value) {
  const auto word = static_cast<std::int32_t>(value);
  if (word != value) [[unlikely]] {
    return static_cast<std::int32_t>(value < 0 ? kS32Min : kS32Max);
  }
  return word;
}

/// Whether `value` lies within -limit..limit, by one comparison. 0 <= limit; |value| + 2 limit
/// < 2^63.
[[nodiscard]] constexpr bool within(std::int64_t value, std::int64_t limit) {
  return static_cast<std::uint64_t>(value + limit) <= static_cast<std::uint64_t>(2 * limit);
}

/// The lower 16 bits with their sign: angles, which wrap.
[[nodiscard]] constexpr std::int32_t wrap_s16(std::int64_t value) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(value));
}

/// Sum or difference of positions, which wrap.
[[nodiscard]] constexpr std::int32_t wrap_s32(std::int64_t value) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
}

/// value / 2^bits, rounded to the nearest, halves upwards. bits >= 1.
[[nodiscard]] constexpr std::int64_t rounded_shift(std::int64_t value, int bits) {
  return (value + (std::int64_t{1} << (bits - 1))) >> bits;
}

/// a / b rounded down. b > 0.
[[nodiscard]] constexpr std::int64_t floor_division(std::int64_t a, std::int64_t b) {
  return (a < 0 ? a - (b - 1) : a) / b;
}

/// Largest integer whose square does not exceed `value`.
[[nodiscard]] constexpr std::int32_t square_root(std::uint32_t value) {
  std::uint32_t root = 0;
  for (std::uint32_t bit = 1U << 30U; bit != 0; bit >>= 2U) {
    const bool fits = value >= root + bit;
    value -= fits ? root + bit : 0;
    root = (root >> 1U) + (fits ? bit : 0);
  }
  return static_cast<std::int32_t>(root);
}

}  // namespace stator::control::foc
