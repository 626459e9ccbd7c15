#pragma once

#include <cmath>
#include <cstdint>

#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"
#include "stator/plant/mechanics/shaft_mechanics.hpp"
#include "stator/plant/motors/two_body_thermal.hpp"

namespace stator::plant {

/// A brushed DC motor with permanent magnets, SI units. The defaults are those of a small 24 V
/// motor of 60 W and 0.4 kg.
struct DcMotorParameters {
  double resistance = 0.6;          ///< R, ohm
  double inductance = 0.2e-3;       ///< L, H
  double torque_constant = 0.035;   ///< K, N m/A and V s/rad
  double rotor_inertia = 7e-6;      ///< J, kg m^2
  double viscous_friction = 5e-6;   ///< B, N m s/rad
  double coulomb_friction = 3e-3;   ///< Tc, N m; brushes included
  double static_friction = 3.6e-3;  ///< Ts, N m, at least Tc
  double stribeck_speed = 0.5;      ///< rad/s at which half of Ts - Tc is left
  double rated_current = 3.0;       ///< A
  /// 1/K of the winding's resistance, which is `resistance` at 25 degree Celsius; copper.
  double resistance_coefficient = 0.00393;
  /// 1/K of the magnets' flux and so of `torque_constant`; ferrite. Magnets are as warm as the
  /// housing.
  double flux_coefficient = -0.002;
  /// Winding inside, housing outside: 80 K above the air at rated current, where 0.6 ohm have
  /// become 0.79.
  ThermalParameters thermal = class_b_motor(7.1, 0.4);
};

struct DcMotorState {
  double current = 0.0;   ///< A
  double speed = 0.0;     ///< rad/s; exactly 0 while the shaft sticks
  ElectricalAngle angle;  ///< of the shaft: one period is one revolution

  friend bool operator==(const DcMotorState&, const DcMotorState&) = default;
};

/// What acts on motor and shaft during one step.
struct DcMotorInput {
  double voltage = 0.0;            ///< V at the terminals, held over the step
  double series_resistance = 0.0;  ///< ohm of the transistors
  double torque = 0.0;             ///< N m on the shaft from outside, positive = forward
  bool open = false;               ///< no current can flow; the voltage is ignored
  bool brake_engaged = false;
};

/// Brushed DC motor with its load:
///   L di/dt = u - R i - K w      J dw/dt = K i - Tfriction(w) - B w + Tload,   dth/dt = w
/// With voltage, load and the sign and size of dry friction held over a step this is a linear
/// system, whose exponential solves it for any length of the step without error: x1 = F x0 + G g
/// with x = (i, w), g = (u/L, T/J), F = exp(A h), G the integral of F; the integral of x likewise.
class DcMotor {
 public:
  DcMotor(const DcMotorParameters& motor, const MechanicalLoad& load);

  /// Advances `state` by `h` seconds; fastest_rate(state) * h must not exceed 0.33. Returns the
  /// mean power the terminals took, W.
  double step(DcMotorState& state, const DcMotorInput& input, double h);

  /// The fastest of R/L, the mechanical resonance with the winding, and end stop, rad/s. What it
  /// limits is how long torques that depend on place are held.
  [[nodiscard]] double fastest_rate() const { return fastest_rate_; }
  /// di/dt with `voltage` at the terminals, A/s.
  [[nodiscard]] double current_slope(const DcMotorState& state, double voltage,
                                     double series_resistance) const {
    return ((voltage - (resistance_ + series_resistance) * state.current) -
            torque_constant_ * state.speed) *
           inverse_inductance_;
  }
  /// Standing with no current at `revolutions`.
  [[nodiscard]] DcMotorState at(double revolutions) const;

  /// Resistance and torque constant from now on: winding and magnets get warm (degree Celsius).
  void set_temperatures(double winding, double magnets);
  /// What is on the shaft from now on.
  void set_load(const MechanicalLoad& load);

  [[nodiscard]] double resistance() const { return resistance_; }            ///< ohm, now
  [[nodiscard]] double torque_constant() const { return torque_constant_; }  ///< N m/A, now
  [[nodiscard]] const DcMotorParameters& motor() const { return motor_; }
  [[nodiscard]] const ShaftMechanics& shaft() const { return shaft_; }

 private:
  struct Matrix {
    double a = 0.0;  ///< row 1
    double b = 0.0;
    double c = 0.0;  ///< row 2
    double d = 0.0;
  };
  /// What a length of the step makes of state and inputs.
  struct Transition {
    double step = -1.0;
    double series_resistance = -1.0;
    bool open = false;
    Matrix state;          ///< F
    Matrix input;          ///< G, s
    Matrix twice;          ///< integral of G, s^2
    double decay = 1.0;    ///< of the current of a shaft that stands
    double charge = 0.0;   ///< s; integral of that decay
    double charge2 = 0.0;  ///< s^2; and of the integral
  };
  static Matrix times(const Matrix& a, const Matrix& b);
  void renew(double h, double series_resistance, bool open);
  double step_at_rest(DcMotorState& state, const DcMotorInput& input, double h) const;

  DcMotorParameters motor_;
  ShaftMechanics shaft_;
  double inverse_inductance_;
  double resistance_;
  double torque_constant_;
  double fastest_rate_ = 0.0;
  Transition transition_;  ///< of the latest step; follows from its length and the temperatures
};

}  // namespace stator::plant
