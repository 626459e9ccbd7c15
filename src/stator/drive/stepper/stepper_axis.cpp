#include "stator/drive/stepper/stepper_axis.hpp"

#include <array>

namespace stator::drive {

namespace {

/// Everything that supervise_stage() watches.
constexpr AxisErrors kDriverErrors{
    AxisError::open_load_a,           AxisError::open_load_b,
    AxisError::overcurrent_a,         AxisError::overcurrent_b,
    AxisError::overcurrent_high_side, AxisError::over_temperature_warning,
    AxisError::over_temperature,      AxisError::undervoltage,
    AxisError::shutdown_switch,       AxisError::stall};
constexpr std::array kShorts{AxisError::overcurrent_a, AxisError::overcurrent_b,
                             AxisError::overcurrent_high_side};
/// Flags of the driver chip that last as long as their cause.
constexpr std::array kDriverConditions{AxisError::open_load_a, AxisError::open_load_b,
                                       AxisError::over_temperature_warning,
                                       AxisError::over_temperature, AxisError::undervoltage};

}  // namespace

StepperAxis::StepperAxis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
                         base::EventReporter reporter)
    : Axis(dictionary, configuration, reporter),
      closed_loop_conditions_(reporter, configuration.number) {
  update_feedback();
  start();
}

void StepperAxis::begin_period(base::SimTime now) {
  update_feedback();
  motion_.set_maximum_velocity(settings_.units.maximum_velocity());
  feedback_.update(encoder_count_, configuration().control_period);
  supervise_closed_loop(now);
}

void StepperAxis::supervise_closed_loop(base::SimTime now) {
  stage_.configure(stepper_settings_.closed_loop, encoder_scale(objects_, stepper_settings_));
  closed_loop_wanted_ = closed_loop_conditions_.fulfilled(objects_, stepper_settings_, now);
  closed_loop_conditions_.explain_torque(enabled() &&
                                             mode() == ModeCode::cyclic_synchronous_torque &&
                                             !closed_loop_wanted_ && !stage_.closed_loop().active(),
                                         now);
  if (motion_.torque()) {
    if (stage_.closed_loop().active()) {
      follow_rotor();
    } else {
      motion_.brake(Braking::slow_down_ramp);
    }
  }
}

void StepperAxis::follow_rotor() {
  const unsigned shift =
      stepper_settings_.microstep_resolution < 8 ? 8U - stepper_settings_.microstep_resolution : 0U;
  const double microstep = 1.0 / static_cast<double>(1U << shift);
  motion_.follow_rotor(stage_.closed_loop().deviation() * microstep,
                       stage_.closed_loop().rotor().velocity() * microstep);
}

void StepperAxis::update_feedback() {
  feedback_.set_scale(objects_.encoder_increments.get(),
                      stepper_settings_.microsteps_per_revolution,
                      stepper_settings_.encoder_reversed);
}

base::AxisActuation StepperAxis::step(base::SimDuration duration,
                                      const base::AxisSensing& sensing) {
  encoder_count_ = sensing.encoder_count;
  coil_current_ = sensing.coil_current;
  if (homing_capture_.armed() || index_latch_.armed()) [[unlikely]] {
    capture_positions(sensing);
  }
  if (switches_changed(sensing.left_switch, sensing.right_switch)) [[unlikely]] {
    follow_limit_switches(switch_levels(sensing));
  }
  motion_.advance(duration);
  stepper_settings_.currents.cool_step_reduction = driver_.current_reduction();
  base::AxisActuation actuation = stage_.advance(motion_.ramp(), stepper_settings_, sensing,
                                                 {.bridge_enabled = power_.bridge_enabled(),
                                                  .brake_released = power_.brake_released(),
                                                  .operation_enabled = enabled(),
                                                  .closed_loop = closed_loop_wanted_,
                                                  .torque = motion_.torque()},
                                                 duration);
  driver_.advance(stepper_settings_, motion_.velocity(), actuation, sensing);
  if (driver_.take_stall()) {
    stop_on_stall();
  }
  return actuation;
}

void StepperAxis::capture_positions(const base::AxisSensing& sensing) {
  const std::int64_t motor = motion_.ramp().motor_microsteps();
  for (PositionCapture* capture : {&homing_capture_, &index_latch_}) {
    capture->observe(reference_signals(sensing), settings_.reference, objects_.uses_encoder(),
                     motor);
  }
}

void StepperAxis::arm_index_latch(bool armed) {
  if (armed) {
    index_latch_.arm_index();
  } else {
    index_latch_.disarm();
  }
}

std::optional<StepperAxis::LatchedPositions> StepperAxis::take_index_latch() {
  const std::optional<CapturedPosition> captured = index_latch_.take();
  if (!captured) {
    return std::nullopt;
  }
  return LatchedPositions{.demand = motion_.position_of(captured->motor_microsteps),
                          .encoder = feedback_.position_at(captured->encoder_count)};
}

void StepperAxis::supervise_stage(base::SimTime now) {
  driver_.supervise(stepper_settings_.driver.limits);
  if (motion_.velocity() != 0.0 || !power_.bridge_enabled()) {
    stalled_ = false;
  }
  const AxisErrors flags = driver_.flags();
  if (flags.empty() && !causes().any_of(kDriverErrors) && !conditions_.shutdown_switch && !stalled_)
      [[likely]] {
    return;
  }
  for (const AxisError error : kDriverConditions) {
    watch(error, flags.has(error), now);
  }
  // The chip remembers a short; its cause went away with the current and cannot hold up a reset.
  for (const AxisError error : kShorts) {
    watch(error, flags.has(error) && !errors().has(error), now);
  }
  watch(AxisError::shutdown_switch, conditions_.shutdown_switch, now);
  watch(AxisError::stall, stalled_, now);
}

void StepperAxis::stop_on_stall() {
  stalled_ = true;
  motion_.brake(Braking::at_once);
}

Axis::StageStatus StepperAxis::stage_status() const {
  return {.closed_loop = stage_.closed_loop().active()};
}

double StepperAxis::actual_velocity() const {
  return objects_.uses_encoder() ? feedback_.velocity() : motion_.velocity();
}

double StepperAxis::torque_current() const {
  return stage_.torque_current(coil_current_);
}

bool StepperAxis::voltage_enabled() const {
  return !driver_.flags().has(AxisError::undervoltage);
}

}  // namespace stator::drive
