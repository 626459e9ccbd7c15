#include "drive/stepper_stage.hpp"

namespace stator::drive {

base::AxisActuation StepperStage::advance(const control::RampGenerator& ramp,
                                          const AxisSettings& settings, bool bridge_enabled,
                                          bool brake_released, base::SimDuration duration) {
  const std::int64_t moved = ramp.motor_microsteps() - motor_microsteps_;
  motor_microsteps_ += moved;
  step_count_ += static_cast<std::uint64_t>(moved < 0 ? -moved : moved);

  base::AxisActuation actuation;
  actuation.brake_released = brake_released;
  actuation.bridge_enabled = bridge_enabled && settings.chopper_enabled;
  if (!actuation.bridge_enabled) {
    selector_.reset();
    return actuation;
  }
  const std::uint8_t current = selector_.advance(settings.currents, ramp.phase(), duration);
  sequencer_.set_resolution(settings.microstep_resolution);
  actuation.coil_current_target = sequencer_.coil_currents(
      motor_microsteps_, settings.full_scale_current * control::current_fraction(current));
  return actuation;
}

}  // namespace stator::drive
