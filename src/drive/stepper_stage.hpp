#pragma once

#include <cstdint>

#include "base/axis_signals.hpp"
#include "base/sim_time.hpp"
#include "control/coil_current_selector.hpp"
#include "control/microstep_sequencer.hpp"
#include "control/ramp_generator.hpp"
#include "drive/axis_settings.hpp"

namespace stator::drive {

/// Turns the set-point of the ramp into coil currents, as sequencer and driver chip of an open-loop
/// stepper axis do, and counts the steps.
class StepperStage {
 public:
  /// Lets `duration` pass at the set-point the ramp has now.
  base::AxisActuation advance(const control::RampGenerator& ramp, const AxisSettings& settings,
                              bool bridge_enabled, bool brake_released, base::SimDuration duration);

  /// Microsteps made since power-on, forward and backward.
  [[nodiscard]] std::uint64_t step_count() const { return step_count_; }

 private:
  control::MicrostepSequencer sequencer_;
  control::CoilCurrentSelector selector_;
  std::int64_t motor_microsteps_ = 0;
  std::uint64_t step_count_ = 0;
};

}  // namespace stator::drive
