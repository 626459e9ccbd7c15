#include "stator/drive/stepper/stepper_stage.hpp"

#include "stator/base/trigonometry.hpp"

namespace stator::drive {

namespace {

using Phase = control::ClosedLoopController::Phase;

/// 1/256 full steps per microstep.
int fine_steps(const StepperSettings& settings) {
  constexpr unsigned kFinest = 8;
  const unsigned resolution = settings.microstep_resolution;
  return 1 << (resolution < kFinest ? kFinest - resolution : 0U);
}

}  // namespace

void StepperStage::follow_ramp(const control::RampGenerator& ramp,
                               const StepperSettings& settings) {
  const std::int64_t moved = ramp.motor_microsteps() - ramp_microsteps_;
  ramp_microsteps_ += moved;
  step_count_ += static_cast<std::uint64_t>(moved < 0 ? -moved : moved);
  set_point_ += moved * fine_steps(settings);
}

base::AxisActuation StepperStage::advance(const control::RampGenerator& ramp,
                                          const StepperSettings& settings,
                                          const base::AxisSensing& sensing,
                                          const StageCommand& command, base::SimDuration duration) {
  base::AxisActuation actuation;
  actuation.brake_released = command.brake_released;
  actuation.bridge_enabled = command.bridge_enabled && settings.chopper_enabled;
  switch_closed_loop(actuation.bridge_enabled && command.closed_loop);
  follow_ramp(ramp, settings);
  vector_ = set_point_;
  if (!actuation.bridge_enabled) {
    selector_.reset();
    return actuation;
  }
  double amplitude = settings.full_scale_current;
  if (closed_loop_.phase() == Phase::off) {
    const std::uint8_t current = selector_.advance(settings.currents, ramp.phase(), duration);
    amplitude *= control::current_fraction(current);
  } else {
    amplitude *= control::current_fraction(settings.currents.run);
    const control::ClosedLoopController::Commutation commutation = closed_loop_.advance(
        {.setpoint = set_point_,
         .velocity = ramp.velocity() * fine_steps(settings),
         .encoder_count = sensing.encoder_count,
         .may_initialise = command.operation_enabled && command.brake_released &&
                           ramp.phase() == control::RampPhase::standstill,
         .torque = command.torque ? std::optional(*command.torque / amplitude) : std::nullopt},
        duration);
    vector_ = commutation.vector;
    amplitude *= commutation.current;
    selector_.reset();
  }
  actuation.coil_current_target = sequencer_.coil_currents(vector_, amplitude);
  return actuation;
}

void StepperStage::switch_closed_loop(bool wanted) {
  if (!wanted) {
    closed_loop_.stop();
  } else if (closed_loop_.phase() == Phase::off) {
    closed_loop_.start();
  }
  if (commutates_ && !closed_loop_.active()) {
    set_point_ = vector_;  // the motor stays where it is
  }
  commutates_ = closed_loop_.active();
}

double StepperStage::torque_current(const std::array<double, 2>& coil_current) const {
  if (!closed_loop_.active()) {
    return 0.0;
  }
  constexpr double kRadians = base::kTwoPi / control::MicrostepSequencer::kTableSize;
  const control::RotorObserver& rotor = closed_loop_.rotor();
  const auto within_period =
      static_cast<double>(rotor.base() % control::MicrostepSequencer::kTableSize);
  const base::SineCosine direction = base::sine_cosine((within_period + rotor.within()) * kRadians);
  return coil_current[1] * direction.cosine - coil_current[0] * direction.sine;
}

}  // namespace stator::drive
