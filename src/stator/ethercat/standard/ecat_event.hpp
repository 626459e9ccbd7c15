#pragma once

#include <cstddef>
#include <cstdint>

/// Bits of the ECAT event request register 0x0210, which each datagram brings to the master in its
/// interrupt field (ETG.1000.4 §6.1.6; same in the TMC8461 datasheet).
namespace stator::ethercat::ecat_event {

inline constexpr std::uint16_t kDcLatch = 1U << 0;
inline constexpr std::uint16_t kDlStatus = 1U << 2;
inline constexpr std::uint16_t kAlStatus = 1U << 3;
/// Mirrors sync manager `channel`; there is room for the first twelve.
constexpr std::uint16_t sync_manager(std::size_t channel) {
  return static_cast<std::uint16_t>(channel < 12 ? 0x10U << channel : 0U);
}

}  // namespace stator::ethercat::ecat_event
