#pragma once

#include <cstdint>

#include "dictionary/dictionary.hpp"

namespace stator::devices::tmcm_3315 {

inline constexpr std::uint8_t kAxisCount = 3;
inline constexpr std::uint16_t kManufacturerAxisOffset = 0x200;  ///< 2000h, 2200h, 2400h
inline constexpr std::uint16_t kProfileAxisOffset = 0x800;       ///< 6000h, 6800h, 7000h

/// The complete object dictionary of the module: 434 entries, three axes.
void add_objects(dictionary::Dictionary& dictionary);

}  // namespace stator::devices::tmcm_3315
