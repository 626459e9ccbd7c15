#pragma once

#include <cstdint>

#include "ethercat/register_table.hpp"

namespace stator::ethercat {

/// The bit of `effect` in a set of effects.
constexpr std::uint64_t bit_of(Effect effect) {
  return std::uint64_t{1} << static_cast<unsigned>(effect);
}

/// Effects of the distributed clocks whose registers are computed for each read.
inline constexpr std::uint64_t kClockReads =
    bit_of(Effect::system_time) | bit_of(Effect::speed_difference) | bit_of(Effect::sync_status) |
    bit_of(Effect::sync_times) | bit_of(Effect::latch_status) | bit_of(Effect::latch_time) |
    bit_of(Effect::buffer_event_time);

/// Effects of the distributed clocks that a write has.
inline constexpr std::uint64_t kClockWrites =
    bit_of(Effect::system_time) | bit_of(Effect::time_setting) | bit_of(Effect::time_loop) |
    bit_of(Effect::time_filter) | bit_of(Effect::speed_filter) | bit_of(Effect::clock_side) |
    bit_of(Effect::sync_activation) | bit_of(Effect::sync_times) | bit_of(Effect::sync_cycle) |
    bit_of(Effect::latch_control);

}  // namespace stator::ethercat
