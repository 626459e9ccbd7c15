// The object dictionary of a TMCM-3315 by firmware version, and the distance of its axes' indices.
#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmcm_3315 {

inline constexpr std::uint8_t kAxisCount = 3;
inline constexpr std::uint16_t kManufacturerAxisOffset = 0x200;  ///< 2000h, 2200h, 2400h
inline constexpr std::uint16_t kProfileAxisOffset = 0x800;       ///< 6000h, 6800h, 7000h

/// The firmware of the module (document L3805-L3813). Others came before and were never deployed,
/// or are older than the document tells anything about.
enum class FirmwareVersion : std::uint8_t {
  v1_07 = 7,  ///< without the N-channel latch 200Fh and cyclic synchronous velocity
  v1_08 = 8,
  v1_09 = 9,
};

/// 1018h:03 of a firmware: major version in the high word, minor in the low one.
constexpr std::uint32_t revision_of(FirmwareVersion firmware) {
  return 0x00010000U | static_cast<std::uint32_t>(firmware);
}

/// The complete object dictionary of the module: 434 entries with firmware 1.08 and 1.09, three
/// axes.
void add_objects(dictionary::Dictionary& dictionary,
                 FirmwareVersion firmware = FirmwareVersion::v1_09);

}  // namespace stator::devices::tmcm_3315
