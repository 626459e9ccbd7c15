#pragma once

#include "stator/experiment/tuning/chip.hpp"
#include "stator/experiment/tuning/winding.hpp"

namespace stator::experiment::tuning {

/// What accelerating and braking with a known current tells.
struct Mechanics {
  Measured flux_linkage;         ///< V s per electrical rad, peak, of a phase
  double torque_constant = 0.0;  ///< N m/A (peak of a phase)
  Measured inertia;              ///< kg m^2, rotor and load
  Measured dry_friction;         ///< N m
  Measured viscous_friction;     ///< N m s/rad
  Measured load_torque;          ///< N m, constant, positive drives forward
  double highest_speed = 0.0;    ///< rad/s reached
};

/// Accelerates and brakes with the current loops closed by the encoder. What the voltage across the
/// magnets is more than the winding's, over the electrical speed, is the flux linkage; torque over
/// acceleration is the inertia, where dry friction is told from it by its sign, viscous friction by
/// speed. Throws TuningError: shaft_blocked, current_range.
[[nodiscard]] Mechanics measure_mechanics(Chip& chip, const Winding& winding,
                                          std::int32_t pole_pairs, std::int32_t resolution);

/// Measures friction and load torque anew, by the current that four velocities take: better than
/// accelerations can tell what is small beside the torque of these. The outer loops are closed.
void measure_friction(Chip& chip, Mechanics& mechanics, double supply);

/// Brings the velocity loop, which is closed, to `target` (rpm) with 30 % of the current, as fast
/// as what braking returns can be burnt, and waits until it is there.
void change_velocity(Chip& chip, const Mechanics& mechanics, double supply, std::int32_t target);

/// One PWM period in which a current along the magnets flows if the supply is above `supply` (V).
void step_burning(Chip& chip, double supply);

/// Burns in the winding, with a current along the magnets, what braking has put into the supply's
/// capacitor, until the supply has `volts` again. The shaft stands; torque mode from then on.
void settle_supply(Chip& chip, double volts);

}  // namespace stator::experiment::tuning
