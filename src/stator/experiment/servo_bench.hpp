#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/plant/axes/servo_axis.hpp"

namespace stator::experiment {

/// `axis` as it stands on a test bench: the shaft turns freely, without end stops, pendulum and
/// switches of the machine it comes from, on a stiff supply; winding and magnets keep the
/// temperature of their sheet.
[[nodiscard]] plant::ServoAxisParameters uncoupled(plant::ServoAxisParameters axis);

/// A three-phase motor on an ideal commutator: voltages on the axes of its rotor.
class CommutatorBench {
 public:
  /// `step`: how often the commutator gives new duties.
  CommutatorBench(const plant::ServoAxisParameters& axis, base::SimDuration step)
      : plant_(axis), step_(step) {}

  /// One step with volts on the axes the rotor has in its middle.
  void drive(double direct, double quadrature, bool brake_chopper_on = false);
  /// One step with a current (A) on the q axis and none on the d axis, as a fast controller that
  /// knows the motor would regulate it.
  void regulate(double quadrature_current, bool brake_chopper_on = false);
  /// One step with the bridge switched off.
  void release();
  /// Turns the shaft at `speed` (rad/s), as an outside machine would.
  void spin(double speed);

  [[nodiscard]] const plant::ServoAxis& plant() const { return plant_; }
  [[nodiscard]] double step() const { return step_.seconds(); }
  /// V, amplitude of the longest voltage vector the supply gives in every direction.
  [[nodiscard]] static double longest_vector(double supply);

 private:
  plant::ServoAxis plant_;
  base::SimDuration step_;
};

}  // namespace stator::experiment
