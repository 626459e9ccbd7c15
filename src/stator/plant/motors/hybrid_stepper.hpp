// The equations of a two-phase hybrid stepper motor with its load; their state and inputs are in SI
// units.
#pragma once

#include <array>
#include <cstdint>

#include "stator/base/trigonometry.hpp"
#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/mechanics/shaft_angle.hpp"
#include "stator/plant/mechanics/shaft_mechanics.hpp"
#include "stator/plant/motors/stepper_motor.hpp"

namespace stator::plant {

struct HybridStepperState {
  std::array<double, 2> current{};  ///< A, phases A and B
  double speed = 0.0;               ///< rad/s, mechanical; exactly 0 while the shaft sticks
  ElectricalAngle angle;            ///< p times the shaft angle

  friend bool operator==(const HybridStepperState&, const HybridStepperState&) = default;
};

/// What acts on motor and shaft during one step.
struct HybridStepperInput {
  std::array<double, 2> voltage{};  ///< V at the phases, held over the step
  std::array<bool, 2> open{};       ///< the phase carries no current (its voltage is ignored)
  double torque = 0.0;              ///< N m on the shaft from outside, positive = forward
  bool brake_engaged = false;
};

/// Two-phase hybrid stepper with its load:
///   L dia/dt = ua - R ia + p w psi sin(p th)      Te = p psi (ib cos(p th) - ia sin(p th))
///   L dib/dt = ub - R ib - p w psi cos(p th)      Tdetent = Td sin(4 p th)
///   J dw/dt  = Te - Tdetent - Tfriction(w) - B w + Tload,   dth/dt = w   (ShaftMechanics)
///
/// Integrated by fourth-order Runge-Kutta with the voltages held in the stator frame.
class HybridStepper {
 public:
  HybridStepper(const StepperMotorParameters& motor, const MechanicalLoad& load);

  /// Advances `state` by `h` seconds; fastest_rate(state) * h must not exceed 0.33 rad.
  void step(HybridStepperState& state, const HybridStepperInput& input, double h) const;
  /// The same where sine and cosine of state.angle are known already.
  void step(HybridStepperState& state, const base::SineCosine& direction,
            const HybridStepperInput& input, double h) const;

  /// The fastest of R/L, p |w|, rotor resonance and end stop, rad/s. While this times the step is
  /// at most 0.33 the error stays below 1e-4 of rated values; it falls with the fourth power of the
  /// step.
  [[nodiscard]] double fastest_rate(const HybridStepperState& state) const;

  /// Voltages induced in the phases when the electrical angle is that of `direction`, V.
  [[nodiscard]] std::array<double, 2> induced_voltage(const base::SineCosine& direction,
                                                      double speed) const;
  [[nodiscard]] double electromagnetic_torque(const HybridStepperState& state) const;  ///< N m
  [[nodiscard]] double detent_torque(const HybridStepperState& state) const;           ///< N m
  /// Torque of load, end stops and `outside_torque` on the shaft without friction, N m, positive =
  /// forward.
  [[nodiscard]] double load_torque(const HybridStepperState& state, double outside_torque) const;
  /// Current vector ahead of the rotor, electrical rad, -pi..pi; pull-out lies at pi/2.
  [[nodiscard]] double load_angle(const HybridStepperState& state) const;
  /// Position of the shaft since the zero of its angle, revolutions.
  [[nodiscard]] double revolutions(const HybridStepperState& state) const {
    return shaft_.revolutions(state.angle);
  }
  /// The angle at which revolutions() is `revolutions`.
  [[nodiscard]] ElectricalAngle angle_at(double revolutions) const {
    return shaft_.angle_at(revolutions);
  }

  [[nodiscard]] const StepperMotorParameters& motor() const { return motor_; }
  /// Resistance of a phase from now on, ohm: a winding gets warm.
  void set_resistance(double resistance) { motor_.resistance = resistance; }
  /// What is on the shaft from now on.
  void set_load(const MechanicalLoad& load);
  /// Kt = p psi, N m/A and V s/rad.
  [[nodiscard]] double torque_constant() const { return torque_constant_; }
  /// Rotor and load, kg m^2.
  [[nodiscard]] double inertia() const { return shaft_.inertia(); }

 private:
  struct Derivative;
  struct StepConstants;

  [[nodiscard]] StepConstants freeze(const HybridStepperState& state,
                                     const HybridStepperInput& input) const;
  [[nodiscard]] Derivative derivative(const StepConstants& frozen,
                                      const std::array<double, 2>& current, double speed,
                                      const base::SineCosine& direction, double turned,
                                      double friction) const;
  [[nodiscard]] double detent_torque(const base::SineCosine& direction) const;
  void step_at_rest(HybridStepperState& state, const HybridStepperInput& input, double step) const;

  StepperMotorParameters motor_;
  ShaftMechanics shaft_;
  std::int64_t pole_pairs_;
  double torque_constant_;        ///< Kt = p psi, N m/A and V s/rad
  double inverse_inductance_;     ///< 1/H
  double electrical_rate_;        ///< R/L at 25 degree Celsius, rad/s
  double standstill_rate_ = 0.0;  ///< fastest_rate at speed 0, rad/s
};

}  // namespace stator::plant
