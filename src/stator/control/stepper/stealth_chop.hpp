#pragma once

#include <array>
#include <cstdint>

namespace stator::control {

/// Quiet chopper (StealthChop): the coils get a sine voltage instead of a regulated current.
struct StealthChopSettings {
  double threshold_velocity = 0.0;  ///< pps below which it is active (20B0h); 0: never
  std::uint8_t gradient = 0;        ///< 0..255 (20B1h); 0: never
  std::uint8_t amplitude = 0;       ///< 0..255 (20B2h)

  [[nodiscard]] bool active_at(double speed) const {
    return threshold_velocity > 0.0 && gradient > 0 && speed < threshold_velocity;
  }
};

/// Frequency of its PWM: two pulses in 1024 clock cycles of 16 MHz, Hz.
inline constexpr double kStealthChopFrequency = 16e6 * 2.0 / 1024.0;

/// Share of the supply voltage the crest of the wave has, 0..1 (TMC2130 data sheet §7.2 without
/// automatic scaling; the offset follows the current scale so that standby current is lower):
///   (amplitude * current + gradient * 256 / TSTEP) / 255
/// with TSTEP the clock cycles of 16 MHz in 1/256 of a full step. `speed`: 1/256 full steps per
/// second; `current`: 0..1 of full scale.
[[nodiscard]] double stealth_chop_duty(const StealthChopSettings& settings, double speed,
                                       double current);

/// The same crest on both coils in the direction of the current targets; {0, 0} without targets.
[[nodiscard]] std::array<double, 2> coil_duty(const std::array<double, 2>& current_target,
                                              double crest);

}  // namespace stator::control
