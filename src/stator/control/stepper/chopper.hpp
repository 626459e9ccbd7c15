#pragma once

#include <cstdint>

namespace stator::control {

/// Registers of a hysteresis chopper (SpreadCycle, TMC262 data sheet §8), as the TMCM-3315 has them
/// in 2092h..2097h.
struct ChopperSettings {
  std::uint8_t blank_time = 2;            ///< 16, 24, 36, 54 clock cycles
  bool constant_off_time = false;         ///< the classic chopper instead of SpreadCycle
  std::uint8_t hysteresis_decrement = 0;  ///< 16, 32, 48, 64 clock cycles per step
  std::int8_t hysteresis_end = 0;         ///< -3..12 steps of the current converter
  std::uint8_t hysteresis_start = 3;      ///< 0..8 steps on top of the end value
  std::uint8_t off_time = 5;              ///< 12 + 32 * value clock cycles; 0: bridge off

  static constexpr double kClockPeriod = 1.0 / 16e6;  // s
  [[nodiscard]] double blank_seconds() const;
  [[nodiscard]] double off_seconds() const;
};

/// What the chopper works on, at the crest of a coil's current.
struct ChopperLoad {
  double supply = 24.0;         ///< V
  double resistance = 0.8;      ///< ohm
  double inductance = 2.1e-3;   ///< H
  double induced = 0.0;         ///< V of EMF against the current
  double current = 0.0;         ///< A
  double converter_step = 0.0;  ///< A per step of the current converter
};

struct ChopperCycle {
  double frequency = 0.0;  ///< Hz; 0 while nothing is chopped
  double ripple = 0.0;     ///< A, peak to peak
};

/// The cycle the chopper settles into; for reports, the simulation itself works with the mean.
///
/// SpreadCycle: on until the current is a hysteresis above its target, slow decay for the off time,
/// fast decay until it is the hysteresis below, slow decay again. The hysteresis starts at start +
/// end with each of the two phases that it ends and falls to the end value by one step per
/// decrement time. Classic: on until the target is reached, slow decay for the off time. No phase
/// that a comparator ends is shorter than the blank time.
[[nodiscard]] ChopperCycle chopper_cycle(const ChopperSettings& settings, const ChopperLoad& load);

}  // namespace stator::control
