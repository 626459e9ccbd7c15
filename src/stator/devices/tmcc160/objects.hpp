#pragma once

#include <array>
#include <cstdint>

#include "stator/devices/tmcc160/options.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmcc160 {

/// What 2704h may be, kbit/s.
inline constexpr std::array<std::int64_t, 8> kBitRates{20, 50, 100, 125, 250, 500, 800, 1000};

/// Adds every object of the TMCC160 and finishes the dictionary. Options add objects that the
/// module itself has not, and widen some (docs/devices/tmcc160.md, "Options").
void add_objects(dictionary::Dictionary& dictionary, const Options& options = {});

}  // namespace stator::devices::tmcc160
