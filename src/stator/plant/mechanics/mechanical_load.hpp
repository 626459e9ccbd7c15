#pragma once

#include <limits>

namespace stator::plant {

/// What is coupled rigidly to the motor shaft; everything is referred to the shaft, SI units.
struct MechanicalLoad {
  double inertia = 0.0;           ///< kg m^2
  double viscous_friction = 0.0;  ///< N m s/rad
  double coulomb_friction = 0.0;  ///< N m; also its value at rest
  double constant_torque =
      0.0;  ///< N m, positive drives the shaft forward; a vertical axis: -m g r
  double unbalance_torque =
      0.0;                    ///< N m, amplitude m g r of a pendulum: -amplitude * sin(shaft angle)
  double brake_torque = 0.0;  ///< N m the holding brake resists with; 0 = none fitted

  /// End stops, revolutions of the shaft; beyond them a spring and a damper push back (never pull).
  double end_stop_minimum = -std::numeric_limits<double>::infinity();
  double end_stop_maximum = std::numeric_limits<double>::infinity();
  double end_stop_stiffness = 200.0;  ///< N m/rad
  double end_stop_damping = 0.02;     ///< N m s/rad
};

}  // namespace stator::plant
