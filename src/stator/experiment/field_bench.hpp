#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/experiment/experiment.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::experiment {

/// `axis` as it stands on a test bench: the shaft turns freely, without end stops, pendulum and
/// switches of the machine it comes from, and the winding keeps the temperature of its sheet.
[[nodiscard]] plant::StepperAxisParameters uncoupled(plant::StepperAxisParameters axis);

/// A motor driven by an ideal sequencer: a current vector of chosen amplitude and angle.
class FieldBench {
 public:
  /// `step`: how often the sequencer gives a new target.
  FieldBench(const plant::StepperAxisParameters& axis, double amplitude, base::SimDuration step)
      : plant_(axis), amplitude_(amplitude), step_(step) {}

  /// One step at whose end the field has turned on by speed() * step.
  void turn();
  void set_speed(double speed) { speed_ = speed; }  ///< of the field, shaft rad/s
  [[nodiscard]] double speed() const { return speed_; }

  /// One step at whose end the field leads the rotor by a right angle: the most torque there is.
  void lead();
  /// One step with the field standing at `angle` (electrical rad from a full step).
  void hold(double angle);
  /// One step with the bridge switched off.
  void release();
  /// Holds the shaft with its brake until the current that lead() asks for flows.
  void build_up_current();
  /// Turns the shaft at `speed` (rad/s), as an outside machine would.
  void spin(double speed);

  /// Field ahead of the rotor in electrical rad, counting whole periods.
  [[nodiscard]] double lag() const;
  /// Rotor's electrical angle since its zero, rad.
  [[nodiscard]] double rotor() const {
    return plant::electrical_radians(plant_.state().motor.angle);
  }
  [[nodiscard]] plant::StepperAxis& plant() { return plant_; }
  [[nodiscard]] const plant::StepperAxis& plant() const { return plant_; }
  [[nodiscard]] double step() const { return step_.seconds(); }

  /// Field and plant, to come back to.
  struct Snapshot {
    plant::StepperAxisState plant;
    plant::ElectricalAngle field;
    double speed = 0.0;
  };
  [[nodiscard]] Snapshot snapshot() const { return {plant_.state(), field_, speed_}; }
  void restore(const Snapshot& snapshot);

 private:
  void drive(bool brake_released = true);

  plant::StepperAxis plant_;
  double amplitude_;
  base::SimDuration step_;
  double speed_ = 0.0;
  plant::ElectricalAngle field_;
};

}  // namespace stator::experiment
