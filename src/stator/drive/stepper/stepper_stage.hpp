#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stator/base/axis_signals.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/control/motion_controller/coil_current_selector.hpp"
#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/control/stepper/closed_loop_controller.hpp"
#include "stator/control/stepper/microstep_sequencer.hpp"
#include "stator/drive/stepper/stepper_settings.hpp"

namespace stator::drive {

/// What the firmware wants of the stage during one step.
struct StageCommand {
  bool bridge_enabled = false;
  bool brake_released = true;
  bool operation_enabled = false;  ///< closed loop may be initialised
  bool closed_loop = false;        ///< wanted, and an encoder is there to make it
  std::optional<double> torque;    ///< A, signed: torque instead of position (closed loop only)
};

/// Turns the set-point of the ramp into coil currents, as sequencer and driver chip of a stepper
/// axis do, in open loop or closed loop, and counts the steps.
///
/// The stage owns the motor's own coordinate: where the current vector stands, in 1/256 full steps
/// since power-on. The ramp enters by its increments alone, so renaming positions (homing, encoder
/// preset) never moves the motor. In open loop the vector is the set-point. In closed loop it may
/// stand elsewhere; when closed loop ends, the set-point of this coordinate moves to the vector and
/// the motor stays where it is, as do all positions an object shows. Steps counted are those of
/// the ramp.
class StepperStage {
 public:
  /// Takes parameters of the closed loop; cheap when nothing has changed.
  void configure(const control::ClosedLoopSettings& settings,
                 const control::EncoderScale& encoder) {
    closed_loop_.configure(settings, encoder);
  }

  /// Lets `duration` pass at the set-point the ramp has at its end; `sensing` is what the sensors
  /// told at its begin.
  base::AxisActuation advance(const control::RampGenerator& ramp, const StepperSettings& settings,
                              const base::AxisSensing& sensing, const StageCommand& command,
                              base::SimDuration duration);

  /// Microsteps made since power-on, forward and backward.
  [[nodiscard]] std::uint64_t step_count() const { return step_count_; }
  [[nodiscard]] const control::ClosedLoopController& closed_loop() const { return closed_loop_; }
  void set_commutation_offset(std::int32_t offset) { closed_loop_.set_commutation_offset(offset); }

  /// The part of a measured current vector that makes torque: the vector times the sine of the load
  /// angle, A, positive = forward; 0 without closed loop, where the rotor's angle is not known.
  [[nodiscard]] double torque_current(const std::array<double, 2>& coil_current) const;

 private:
  void follow_ramp(const control::RampGenerator& ramp, const StepperSettings& settings);
  void switch_closed_loop(bool wanted);

  control::MicrostepSequencer sequencer_;
  control::CoilCurrentSelector selector_;
  control::ClosedLoopController closed_loop_;
  std::int64_t ramp_microsteps_ = 0;  ///< as last seen
  std::int64_t set_point_ = 0;        ///< 1/256 full steps
  std::int64_t vector_ = 0;           ///< 1/256 full steps
  bool commutates_ = false;           ///< closed loop was active in the step before
  std::uint64_t step_count_ = 0;
};

}  // namespace stator::drive
