#pragma once

#include <complex>

namespace stator::experiment::tuning {

/// The cascade as a linear system, with the gains it has after rounding.
///
/// Current: pole-zero cancellation leaves i(k+2) = i(k+1) + g (target(k) - i(k)), g = gain of the
/// controller times period over inductance, where the shaft stands; the EMF of a shaft that is free
/// takes some of the voltage. Velocity: PI with the advanced structure, inertia and
/// viscous friction, and the meter, a mean over 915.5 us looked at every 228.9 us. Position: P.
struct LoopModel {
  double period = 40e-6;           ///< s, of the PWM
  double current_share = 0.0;      ///< g
  double resistance = 1.0;         ///< ohm
  double inductance = 1e-3;        ///< H
  double emf_constant = 0.0;       ///< V s/rad of the shaft, against the current
  double velocity_gain = 0.0;      ///< A s/rad
  double velocity_integral = 0.0;  ///< 1/s: gain of the integral over that of the error
  double position_gain = 0.0;      ///< 1/s
  double torque_constant = 0.0;    ///< N m/A
  double inertia = 0.0;            ///< kg m^2
  double viscous_friction = 0.0;   ///< N m s/rad

  using Response = std::complex<double>;
  // Closed loops at `frequency` (Hz): actual value as the registers show it over target.
  [[nodiscard]] Response current(double frequency) const;
  [[nodiscard]] Response locked_current(double frequency) const;  ///< while the shaft stands
  [[nodiscard]] Response velocity(double frequency) const;
  [[nodiscard]] Response position(double frequency) const;

  /// From the torque target to the measured velocity, rad/s per A.
  [[nodiscard]] Response velocity_path(double frequency) const;
  [[nodiscard]] Response velocity_controller(double frequency) const;  ///< A s/rad
  /// The velocity meter alone.
  [[nodiscard]] static Response meter(double frequency);
};

/// Hz at which the magnitude of the response falls below 1/sqrt 2 for the first time; 0 if it does
/// not below half the PWM frequency.
[[nodiscard]] double bandwidth_of(const LoopModel& model,
                                  LoopModel::Response (LoopModel::*loop)(double) const);

/// The highest magnitude of the response.
[[nodiscard]] double peak_of(const LoopModel& model,
                             LoopModel::Response (LoopModel::*loop)(double) const);

}  // namespace stator::experiment::tuning
