#pragma once

#include <cstdint>

namespace stator::control::foc {

/// A bit range of a register or of one of the views behind a pair of data and address register.
struct Field {
  std::uint8_t address;  ///< 00h..7Fh
  std::int16_t view;     ///< index written to the address register, or kPlain
  std::uint8_t low;      ///< lowest bit
  std::uint8_t high;     ///< highest bit
  bool is_signed;        ///< two's complement

  friend bool operator==(const Field&, const Field&) = default;
};

/// A register that shows one thing only.
inline constexpr std::int16_t kPlain = -1;

/// Bits of the field, in their place.
[[nodiscard]] constexpr std::uint32_t mask(const Field& f) {
  return (0xFFFFFFFFU >> (31 - (f.high - f.low))) << f.low;
}

/// Value of the field in the content of its register, with its sign.
[[nodiscard]] constexpr std::int32_t extract(std::uint32_t word, const Field& f) {
  const std::uint32_t top = word << (31 - f.high);
  const int width = f.high - f.low;
  return f.is_signed ? static_cast<std::int32_t>(top) >> (31 - width)
                     : static_cast<std::int32_t>(top >> (31 - width));
}

/// The same without sign, for fields of 32 bits.
[[nodiscard]] constexpr std::uint32_t extract_unsigned(std::uint32_t word, const Field& f) {
  return (word & mask(f)) >> f.low;
}

/// The field's part of a register's content; what does not fit is cut off.
[[nodiscard]] constexpr std::uint32_t placed(std::int64_t value, const Field& f) {
  return (static_cast<std::uint32_t>(value) << f.low) & mask(f);
}

}  // namespace stator::control::foc
