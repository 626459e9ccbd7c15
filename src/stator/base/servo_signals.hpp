#pragma once

#include <array>
#include <cstdint>

namespace stator::base {

// The seam between the firmware of a servo drive and the world, once per period of its current
// loop; see axis_signals.hpp for stepper drives.

/// What the half bridges of a three-phase motor are told, for one period.
struct ServoActuation {
  bool bridge_enabled = false;    ///< false: all six transistors off, currents decay in diodes
  std::array<double, 3> duty{};   ///< 0..1, share of the period phases U, V, W are at the supply
  bool brake_released = true;     ///< holding brake, if one is fitted
  bool brake_chopper_on = false;  ///< the resistor across the supply conducts

  friend bool operator==(const ServoActuation&, const ServoActuation&) = default;
};

/// What the sensors tell, at the end of the period.
struct ServoSensing {
  std::array<double, 3> phase_current{};     ///< A, measured, positive into the motor
  std::uint8_t halls = 0;                    ///< bits 0, 1, 2: levels of H1, H2, H3
  std::int64_t encoder_count = 0;            ///< quadrature counts since power-on, not wrapped
  bool encoder_index = false;                ///< N channel level
  std::uint32_t encoder_index_passages = 0;  ///< N pulses met since power-on, modulo 2^32
  std::int64_t encoder_index_count = 0;      ///< encoder_count at the latest N pulse (a latch)
  bool left_switch = false;                  ///< switch inputs, true = signal high
  bool right_switch = false;
  bool home_switch = false;
  double supply_voltage = 24.0;       ///< V at the power stage
  double driver_temperature = 25.0;   ///< degree Celsius
  std::array<bool, 3> overcurrent{};  ///< a phase draws more than the bridge bears
  bool overcurrent_high_side = false;
};

}  // namespace stator::base
