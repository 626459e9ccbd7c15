#pragma once

#include <array>
#include <cstdint>

#include "dictionary/dictionary.hpp"

namespace stator::devices::tmcc160 {

/// What 2704h may be, kbit/s.
inline constexpr std::array<std::int64_t, 8> kBitRates{20, 50, 100, 125, 250, 500, 800, 1000};

/// Adds every object of the TMCC160 and finishes the dictionary. `serves_eds` adds 1021h and 1022h,
/// which the module itself has not (docs/devices/tmcc160.md, "Options").
void add_objects(dictionary::Dictionary& dictionary, bool serves_eds = false);

}  // namespace stator::devices::tmcc160
