#pragma once

#include <array>
#include <cstdint>

namespace stator::base {

// The seam between a drive's firmware and the world: what crosses the connectors of a power stage
// and its sensors, once per plant step. `control` and `drive` know only these structs; `plant`
// turns one into the other; a device wires them together as a board would.

/// What the power stage is told, for one step.
struct AxisActuation {
  bool bridge_enabled = false;                  ///< false: all transistors off, coils free-wheel
  std::array<double, 2> coil_current_target{};  ///< A, phases A and B of a two-phase motor
  bool brake_released = true;                   ///< holding brake, if one is fitted
  bool voltage_mode = false;                    ///< the coils get coil_duty instead of currents
  std::array<double, 2> coil_duty{};            ///< -1..1 of the supply voltage, in voltage mode

  friend bool operator==(const AxisActuation&, const AxisActuation&) = default;
};

/// What the sensors tell, at the end of the step.
struct AxisSensing {
  std::array<double, 2> coil_current{};      ///< A, measured in phases A and B
  std::int64_t encoder_count = 0;            ///< quadrature counts since power-on, not wrapped
  bool encoder_index = false;                ///< N channel level, before polarity
  std::uint32_t encoder_index_passages = 0;  ///< N pulses met since power-on, modulo 2^32
  std::int64_t encoder_index_count = 0;      ///< encoder_count at the latest N pulse (a latch)
  bool left_switch = false;                  ///< switch inputs, true = signal high
  bool right_switch = false;
  bool home_switch = false;
  double supply_voltage = 24.0;      ///< V at the power stage
  double driver_temperature = 25.0;  ///< degree Celsius

  /// What a driver chip derives from the on-times of its chopper; averages over the step.
  double induced_voltage = 0.0;   ///< V, amplitude of the motor's EMF, positive = forward
  double converted_power = 0.0;   ///< W, EMF times current: what the coils give to the shaft
  bool current_regulated = true;  ///< the supply sufficed to bring the coils to their targets

  std::array<bool, 2> overcurrent{};   ///< a short of phase A or B draws more than the bridge bears
  bool overcurrent_high_side = false;  ///< the same through the high-side transistors
};

}  // namespace stator::base
