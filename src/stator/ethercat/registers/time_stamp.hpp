#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

/// The two sides of a slave controller.
enum class AccessSide : std::uint8_t { bus, host };

/// A time in several register bytes that a side may read in several accesses: reading the lowest
/// byte freezes the others for that side, so that the bytes belong together (TMC8461 datasheet,
/// registers 0x0910, 0x09B0..0x09CF, 0x09F0..0x09FF).
template <typename Number>
class TimeStamp {
 public:
  explicit constexpr TimeStamp(std::size_t address) : address_(address) {}

  [[nodiscard]] constexpr bool touched_by(std::size_t address, std::size_t length) const {
    return touches(address, length, address_, sizeof(Number));
  }
  /// Puts into the registers what an access of `side` to `length` bytes from `address` on sees
  /// while the time is `current`.
  void show(std::span<std::byte, kRegisterSpace> registers, AccessSide side, std::size_t address,
            std::size_t length, Number current) {
    if (!touched_by(address, length)) {
      return;
    }
    Number& frozen = frozen_[static_cast<std::size_t>(side)];
    if (address <= address_) {
      frozen = current;
    }
    base::store_le(registers, address_, frozen);
  }
  void reset() { frozen_ = {}; }

 private:
  std::size_t address_;
  std::array<Number, 2> frozen_{};
};

}  // namespace stator::ethercat
