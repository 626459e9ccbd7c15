#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace stator::ethercat {

/// One fieldbus memory management unit: maps a range of logical bits to physical memory
/// (ETG.1000.4 §6.2; registers 0x0600 + 16 n).
struct Fmmu {
  static constexpr std::size_t kRegisterLength = 16;

  std::uint32_t logical_start = 0;
  std::uint16_t length = 0;  ///< logical bytes touched, the first and the last included
  std::uint8_t logical_start_bit = 0;
  std::uint8_t logical_stop_bit = 0;  ///< last mapped bit in the last byte
  std::uint16_t physical_start = 0;
  std::uint8_t physical_start_bit = 0;
  bool reads = false;
  bool writes = false;

  /// The unit as its registers stand; nothing if it is not active or maps no bit.
  static std::optional<Fmmu> decode(std::span<const std::byte, kRegisterLength> registers);

  /// Logical bit address of the first mapped bit.
  [[nodiscard]] std::uint64_t first_bit() const {
    return std::uint64_t{logical_start} * 8 + logical_start_bit;
  }
  /// Logical bit address behind the last mapped bit.
  [[nodiscard]] std::uint64_t end_bit() const {
    return (std::uint64_t{logical_start} + length - 1) * 8 + logical_stop_bit + 1;
  }
  /// Whole bytes are mapped to whole bytes.
  [[nodiscard]] bool byte_aligned() const {
    return logical_start_bit == 0 && logical_stop_bit == 7 && physical_start_bit == 0;
  }
};

/// Copies `count` bits from `source`, starting `source_bit` bits behind its beginning, to
/// `destination` at `destination_bit`; bit 0 of a byte is its least significant one. Other bits of
/// the destination stay. The ranges must not overlap.
void copy_bits(std::byte* destination, std::size_t destination_bit, const std::byte* source,
               std::size_t source_bit, std::size_t count);

/// An FMMU compiled for the frame path: byte-aligned and leading either to one buffered sync
/// manager or to memory that can be moved without looking at rights and effects.
struct DirectMapping {
  static constexpr std::uint8_t kNoChannel = 0xFF;

  std::uint32_t first = 0;        ///< logical address of the first byte
  std::uint32_t last = 0;         ///< logical address of the last byte
  std::uint32_t memory = 0;       ///< physical address of the first byte; without channel
  std::uint16_t area_offset = 0;  ///< of the first byte in the sync manager's area
  std::uint8_t channel = kNoChannel;
};

}  // namespace stator::ethercat
