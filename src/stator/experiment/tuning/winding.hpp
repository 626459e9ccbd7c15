#pragma once

#include <array>
#include <cstdint>

#include "stator/experiment/tuning/chip.hpp"

namespace stator::experiment::tuning {

/// What currents in a motor that stands tell.
struct Winding {
  std::array<Measured, 2> offsets{};  ///< counts of I0 and I1 without current
  std::int32_t current_scale = 256;   ///< 256 or, with reversed amplifiers, -256
  Measured supply;                    ///< V
  /// Ohm of a phase (half of line to line) with the transistors of its half bridges.
  Measured resistance;
  Measured direct_inductance;      ///< H, along the magnets
  Measured quadrature_inductance;  ///< H, across them
};

/// Raw values of the current converters with the power stage off; sets the offset registers.
/// Throws TuningError: supply_too_low, current_range, current_sensing.
void measure_offsets(Chip& chip, Winding& winding);

/// Drives a current through each phase in turn and sets the sign of the scales. The resistance is
/// the difference of two voltages over that of their currents, so that what dead time and diodes
/// take drops out. Throws TuningError: no_motor, phase_open, current_sensing, supply_too_low.
void measure_resistance(Chip& chip, Winding& winding);

/// Holds the rotor with a current and adds a sine of a 16th of the PWM frequency along and across
/// it. The inductance is that for which the winding, with its voltage held over each period,
/// answers as strongly as measured; delays do not matter. A current along the magnets keeps dead
/// time from changing sign.
void measure_inductances(Chip& chip, Winding& winding);

/// Turns the field to `phi` and raises the voltage along it until one phase carries `current`.
/// Returns U_D; 0 if the voltage does not suffice.
[[nodiscard]] std::int32_t raise_current(Chip& chip, std::int32_t phi, double current);

/// Waits until the encoder has been still for 30 ms, for `longest` seconds at most.
void wait_for_rest(Chip& chip, double longest);

}  // namespace stator::experiment::tuning
