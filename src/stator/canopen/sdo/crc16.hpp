// The checksum of SDO block transfers (CiA 301 §7.2.4.3.16), computed with a table of 256 entries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace stator::canopen {

namespace detail {
inline constexpr std::array<std::uint16_t, 256> kCrc16Table = [] {
  std::array<std::uint16_t, 256> table{};
  for (unsigned i = 0; i < table.size(); ++i) {
    unsigned remainder = i << 8;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 0x8000) != 0 ? remainder << 1 ^ 0x1021 : remainder << 1;
    }
    table[i] = static_cast<std::uint16_t>(remainder);
  }
  return table;
}();
}  // namespace detail

/// Checksum of SDO block transfers (CiA 301 §7.2.4.3.16): polynomial 1021h, initial value 0, not
/// reflected. "123456789" gives 31C3h.
[[nodiscard]] constexpr std::uint16_t crc16(std::span<const std::byte> bytes) {
  std::uint16_t remainder = 0;
  for (const std::byte byte : bytes) {
    remainder = static_cast<std::uint16_t>(
        remainder << 8 ^
        detail::kCrc16Table[(remainder >> 8 ^ std::to_integer<unsigned>(byte)) & 0xFF]);
  }
  return remainder;
}

}  // namespace stator::canopen
