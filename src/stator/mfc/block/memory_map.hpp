#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/mfc/pins/configuration.hpp"
#include "stator/mfc/registers/register_map.hpp"

namespace stator::mfc {

/// A register that is transferred to or from process data.
struct MappedRegister {
  std::uint8_t number = 0;
  std::uint8_t size = 0;  ///< bytes transferred; what follows up to a multiple of 4 is padding
  Trigger trigger = Trigger::always;
  std::uint32_t address = 0;  ///< of its first byte in the controller's memory

  [[nodiscard]] constexpr std::uint32_t end() const { return address + size; }
};

/// Where the enabled registers lie in the process data RAM (TMC8461 datasheet section 7.8,
/// L8760-L8830): in ascending order of their numbers, each at a multiple of 4 bytes from the start
/// of its block, write registers in block 0 and read registers in block 1.
class MemoryMap {
 public:
  static constexpr std::uint32_t kMemoryBegin = 0x1000;
  static constexpr std::uint32_t kMemoryEnd =
      0x5000;  ///< first address behind the process data RAM

  MemoryMap() = default;
  explicit MemoryMap(const Configuration& configuration);

  struct Block {
    std::uint32_t start = 0;
    std::uint32_t length = 0;  ///< bytes, the padding of the last register included
    [[nodiscard]] constexpr std::uint32_t end() const { return start + length; }
    /// It lies in the process data RAM; a block that does not is not transferred.
    [[nodiscard]] constexpr bool valid() const {
      return start >= kMemoryBegin && end() <= kMemoryEnd;
    }
    [[nodiscard]] constexpr bool overlaps(std::uint32_t from, std::uint32_t to) const {
      return length != 0 && from < end() && start < to;
    }
  };
  /// 0: written by the master; 1: read by it.
  [[nodiscard]] const Block& block(unsigned number) const { return blocks_[number]; }
  /// The block's registers by address.
  [[nodiscard]] std::span<const MappedRegister> registers(unsigned block) const {
    return block == 0 ? std::span(registers_).first(write_count_)
                      : std::span(registers_).subspan(write_count_, read_count_);
  }
  /// Whether the master has register `number`, by its configuration byte.
  [[nodiscard]] bool mapped(std::size_t number) const {
    return number < kMappableCount && (mapped_ >> number & 1U) != 0;
  }

 private:
  std::size_t place(const Configuration& configuration, Direction direction, std::size_t from);

  // The constructor fills the first three while it works out the last two.
  std::array<Block, 2> blocks_{};
  std::array<MappedRegister, kMappableCount> registers_{};  ///< of block 0, then of block 1
  std::uint64_t mapped_ = 0;
  std::size_t write_count_ = 0;
  std::size_t read_count_ = 0;
};

}  // namespace stator::mfc
