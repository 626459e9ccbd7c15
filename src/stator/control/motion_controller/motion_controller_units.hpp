#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::control::motion_controller {

// Units of the motion controller chip TMC457 at 16 MHz (TMCM-142 L5878-L5902, A23, A24). Per clock
// they are powers of two:
//   velocity      2^-30 microsteps / clock     = 2 fCLK / 2^31 pps              = 0.0149 pps
//   acceleration  2^-42 microsteps / clock^2   = fCLK^2 / (16 * 256) / 2^30     = 58.2 pps/s
//   bow           2^-50 microsteps / clock^3, one unit of acceleration per 256 clocks
// Each is a whole number of 5^n / 2^m, so a double holds every register's value in pps exactly.

inline constexpr std::int64_t kClock = 16'000'000;  ///< Hz

inline constexpr double kVelocityUnit = 15'625.0 / 1'048'576.0;           ///< pps
inline constexpr double kAccelerationUnit = 244'140'625.0 / 4'194'304.0;  ///< pps/s
inline constexpr double kBowUnit = 3'814'697'265'625.0 / 1'048'576.0;     ///< pps/s^2

/// Of positions and times of the regulator and the standby delay.
inline constexpr base::SimDuration kRegulatorPeriod{8'000};        ///< 128 clocks
inline constexpr base::SimDuration kStandbyUnit{4'096'000};        ///< 65536 clocks (A25)
inline constexpr std::int64_t kStepPulseUnitPicoseconds = 62'500;  ///< one clock

/// Highest index of AP 18.
inline constexpr std::uint8_t kMaximumBow = 18;

/// Bow in units of acceleration per 256 clocks: 2^(index - 1); 0 = infinite, the trapezoid (A24).
[[nodiscard]] constexpr std::uint32_t bow_value(std::uint8_t index) {
  return index == 0 ? 0U : 1U << (index - 1U);
}

/// `numerator / denominator` to the nearest, halves away from zero; `denominator` > 0.
[[nodiscard]] constexpr std::int64_t rounded_quotient(std::int64_t numerator,
                                                      std::int64_t denominator) {
  const std::int64_t half = denominator / 2;
  return (numerator < 0 ? numerator - half : numerator + half) / denominator;
}

// Between registers and whole microsteps per second (AP 255, A54), to the nearest. Velocities:
// |pps| <= 32,000,000; accelerations: |pps/s| <= 976,562,442.

[[nodiscard]] constexpr std::int64_t velocity_of_pps(std::int64_t pps) {
  return rounded_quotient(pps * 1'048'576, 15'625);
}
[[nodiscard]] constexpr std::int64_t pps_of_velocity(std::int64_t velocity) {
  return rounded_quotient(velocity * 15'625, 1'048'576);
}
[[nodiscard]] constexpr std::int64_t acceleration_of_pps2(std::int64_t pps2) {
  return rounded_quotient(pps2 * 4'194'304, 244'140'625);
}
[[nodiscard]] constexpr std::int64_t pps2_of_acceleration(std::int64_t acceleration) {
  return rounded_quotient(acceleration * 244'140'625, 4'194'304);
}

}  // namespace stator::control::motion_controller
