#pragma once

#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::experiment {

/// The closed formulas of a two-phase hybrid stepper on a chopper, for comparison with what the
/// bench measures on the model; docs/physics.md derives them. SI units; currents are amplitudes of
/// the current vector (sqrt(2) times the rms value of a phase), speeds those of the shaft.
///
/// The motor's additional breakaway friction (Ts - Tc) is not part of them, nor are end stops and a
/// pendulum.
class Equations {
 public:
  explicit Equations(const plant::StepperAxisParameters& axis);

  [[nodiscard]] double torque_constant() const { return torque_constant_; }  ///< Kt = p psi, N m/A
  [[nodiscard]] double inertia() const { return inertia_; }                  ///< J, kg m^2
  [[nodiscard]] double viscous_friction() const { return viscous_; }         ///< B, N m s/rad
  [[nodiscard]] double coulomb_friction() const { return coulomb_; }         ///< Tc, N m
  /// Amplitude of the rated current, A.
  [[nodiscard]] double rated_current() const;

  /// Torque it takes to keep a forward speed: Tc + B w - Tload, N m.
  [[nodiscard]] double running_torque(double speed) const;
  /// Z = sqrt(R^2 + (p w L)^2), ohm.
  [[nodiscard]] double impedance(double speed) const;

  /// Speed up to which the supply can drive `current` in quadrature to the rotor's field:
  /// (R I + Kt w)^2 + (p w L I)^2 = V^2.
  [[nodiscard]] double corner_speed(double current) const;
  /// How many times the supply it would take to let the regulator follow its target: Z I / V.
  [[nodiscard]] double regulator_demand(double speed, double current) const;
  /// Pull-out torque of a regulated current: Kt I.
  [[nodiscard]] double regulated_pull_out(double current) const;
  /// Pull-out torque of phase voltages whose fundamental has `amplitude`:
  /// Kt U / Z - Kt^2 w R / Z^2.
  [[nodiscard]] double voltage_pull_out(double speed, double amplitude) const;
  /// The same of a regulator that is saturated all the time: square waves, U = 4/pi V.
  [[nodiscard]] double saturated_pull_out(double speed) const;

  /// Torque per electrical radian that draws the rotor back to a full step: Th + 4 Td, N m.
  [[nodiscard]] double stiffness(double current) const;
  /// w0 = sqrt(p (Th + 4 Td) / J) around a full step, rad/s.
  [[nodiscard]] double natural_frequency(double current) const;
  /// Damping from viscous friction: B / (2 J), 1/s.
  [[nodiscard]] double decay_rate() const { return viscous_ / (2.0 * inertia_); }
  /// Logarithmic decrement per period of the damped oscillation.
  [[nodiscard]] double logarithmic_decrement(double current) const;
  /// Electrical radians by which dry friction keeps the rotor off a full step.
  [[nodiscard]] double dry_deflection(double current) const;

  /// Speed `time` after standstill under the constant torque Kt I, rad/s.
  [[nodiscard]] double accelerated_speed(double current, double time) const;
  /// Time until that speed is reached, s; infinite if it never is.
  [[nodiscard]] double acceleration_time(double current, double speed) const;
  /// Speed `time` after the motor was let go at `initial_speed`, rad/s; 0 once it has stopped.
  [[nodiscard]] double coasting_speed(double initial_speed, double time) const;
  /// When it stops: J/B ln(1 + B w0 / Tc), s.
  [[nodiscard]] double coasting_time(double initial_speed) const;
  /// sin of the load angle at which the motor gives `torque` with `current`, held to -1..1.
  [[nodiscard]] double load_angle_sine(double torque, double current) const;

  /// StallGuard2 value of a motor that gives `torque` at `speed` with `current`: what the load
  /// leaves of the EMF, Kt w (1 - T / (Kt I)), times `counts_per_volt`; 0..1023.
  [[nodiscard]] double stall_guard(double speed, double torque, double current,
                                   double counts_per_volt) const;

 private:
  plant::StepperMotorParameters motor_;
  double supply_;
  double torque_constant_;
  double inertia_;
  double viscous_;
  double coulomb_;
  double load_torque_;  ///< N m, positive drives forward
};

}  // namespace stator::experiment
