#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace stator::base {

/// CRC-32 of IEEE 802.3 (reflected polynomial EDB88320h, as zip and Ethernet have it), piece by
/// piece. "123456789" gives CBF43926h.
class Crc32 {
 public:
  constexpr void add(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {
      remainder_ =
          kTable[(remainder_ ^ std::to_integer<std::uint32_t>(byte)) & 0xFF] ^ remainder_ >> 8;
    }
  }
  /// Of all bytes so far; 0 for none.
  [[nodiscard]] constexpr std::uint32_t value() const { return ~remainder_; }

 private:
  static constexpr std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t remainder = i;
      for (int bit = 0; bit < 8; ++bit) {
        remainder = (remainder & 1) != 0 ? remainder >> 1 ^ 0xEDB88320U : remainder >> 1;
      }
      table[i] = remainder;
    }
    return table;
  }();

  std::uint32_t remainder_ = 0xFFFFFFFFU;
};

[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::byte> bytes) {
  Crc32 crc;
  crc.add(bytes);
  return crc.value();
}

}  // namespace stator::base
