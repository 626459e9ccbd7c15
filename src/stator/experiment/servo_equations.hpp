#pragma once

#include <array>

#include "stator/control/servo/servo_settings.hpp"
#include "stator/plant/axes/servo_axis.hpp"

namespace stator::experiment {

/// What closed formulas say of a three-phase motor with its load, SI units. Cogging is left out:
/// its mean is 0.
class ServoEquations {
 public:
  explicit ServoEquations(const plant::ServoAxisParameters& axis);

  /// The steady state at a speed with a voltage on the q axis.
  struct Point {
    double direct_current;      ///< A
    double quadrature_current;  ///< A
    double torque;              ///< N m, electromagnetic
    double shaft_torque;        ///< N m, less friction
    double efficiency;          ///< shaft power over electrical power
  };
  ///   id = we Lq iq / R    iq = (u - we psi) / (R + we^2 Ld Lq / R)
  [[nodiscard]] Point at(double speed, double voltage) const;
  /// Speed at which the torque just covers friction and the load, rad/s.
  [[nodiscard]] double free_speed(double voltage) const;

  /// Peak of the EMF between two lines of a sinusoidal motor: sqrt(3) p psi w, V.
  [[nodiscard]] double line_to_line_emf(double speed) const;
  /// w(t) of a shaft slowed by `braking` N m and friction:
  ///   (w0 + T/B) exp(-B t/J) - T/B,  T = braking + Tc - load; 0 after it stopped
  [[nodiscard]] double slowing_speed(double initial, double braking, double time) const;
  /// The angle it turns meanwhile, rad, and when it stops, s.
  [[nodiscard]] double slowing_angle(double initial, double braking, double time) const;
  [[nodiscard]] double slowing_time(double initial, double braking) const;

  [[nodiscard]] double torque_constant() const { return torque_constant_; }  ///< 3/2 p psi
  [[nodiscard]] double resistance() const { return resistance_; }  ///< winding and transistor
  [[nodiscard]] double inertia() const { return inertia_; }
  [[nodiscard]] double viscous_friction() const { return viscous_; }
  [[nodiscard]] double coulomb_friction() const { return coulomb_; }

 private:
  plant::ThreePhaseMotorParameters motor_;
  double resistance_;
  double torque_constant_;
  double inertia_;
  double viscous_;
  double coulomb_;
  double load_torque_;  ///< N m, positive drives forward
};

/// The cascade of a servo drive as a linear sampled system, exactly solved from period to period:
/// voltage held over a period of 50 us and one period late, loops as ServoControllerSettings
/// states them in SI units, velocity from the angle of one millisecond to the next. No limits, no
/// rounding, no friction but the viscous one; the d axis stays at 0.
class LinearServo {
 public:
  /// `locked`: the shaft does not turn.
  LinearServo(const ServoEquations& equations, const plant::ThreePhaseMotorParameters& motor,
              const control::ServoControllerSettings& gains, bool locked);

  /// What the outermost closed loop is told.
  struct Target {
    control::ServoLoop loop = control::ServoLoop::torque;
    double value = 0.0;  ///< A, rad/s or rad
  };
  /// One period of 50 us.
  void step(const Target& target);

  [[nodiscard]] double current() const { return state_[0]; }  ///< A
  [[nodiscard]] double speed() const { return state_[1]; }    ///< rad/s
  [[nodiscard]] double angle() const { return state_[2]; }    ///< rad

 private:
  void run_outer_loops(const Target& target);

  std::array<std::array<double, 3>, 3> transition_{};  ///< of (current, speed, angle)
  std::array<double, 3> by_voltage_{};
  double current_p_;   ///< V/A
  double current_i_;   ///< V/A and period
  double velocity_p_;  ///< A s/rad
  double velocity_i_;  ///< A s/rad and millisecond
  double position_p_;  ///< 1/s
  int period_ = 0;
  std::array<double, 3> state_{};
  double last_angle_ = 0.0;
  double current_sum_ = 0.0;
  double speed_sum_ = 0.0;
  double current_target_ = 0.0;
  double voltage_ = 0.0;
};

}  // namespace stator::experiment
