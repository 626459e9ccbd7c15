#include "stator/drive/servo/servo_axis.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

namespace stator::drive {

namespace {

using control::ServoCommutation;

constexpr double kSecondsPerMinute = 60.0;
constexpr double kAmperesPerMilliampere = 1e-3;

/// Seen in a period of the current loop and remembered until the fault reset.
constexpr std::array kShorts{AxisError::overcurrent_a, AxisError::overcurrent_b,
                             AxisError::overcurrent_c, AxisError::overcurrent_high_side};
constexpr AxisErrors kShortErrors{AxisError::overcurrent_a, AxisError::overcurrent_b,
                                  AxisError::overcurrent_c, AxisError::overcurrent_high_side};
/// As long as their cause lasts.
constexpr std::array kStageConditions{AxisError::undervoltage, AxisError::overvoltage,
                                      AxisError::over_temperature_warning,
                                      AxisError::over_temperature, AxisError::hall_error};
constexpr AxisErrors kStageConditionErrors{AxisError::undervoltage, AxisError::overvoltage,
                                           AxisError::over_temperature_warning,
                                           AxisError::over_temperature, AxisError::hall_error};
constexpr AxisErrors kWatched =
    kStageConditionErrors | kShortErrors |
    AxisErrors{AxisError::initialisation_error, AxisError::overload, AxisError::shutdown_switch};

}  // namespace

ServoAxis::ServoAxis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
                     base::EventReporter reporter)
    : Axis(dictionary, configuration, reporter) {
  settings_.behaviour = kServoBehaviour;
  configure();
  start();
}

void ServoAxis::switch_off_on_overcurrent(const base::ServoSensing& sensing) {
  if (!power_.bridge_enabled()) {
    return;
  }
  const auto note = [this](AxisError error, bool seen) {
    stage_errors_.set(error, seen || stage_errors_.has(error));
  };
  note(AxisError::overcurrent_a, sensing.overcurrent[0]);
  note(AxisError::overcurrent_b, sensing.overcurrent[1]);
  note(AxisError::overcurrent_c, sensing.overcurrent[2]);
  note(AxisError::overcurrent_high_side, sensing.overcurrent_high_side);
  set_point_.loop = control::ServoLoop::off;
}

void ServoAxis::observe_homing(const base::ServoSensing& sensing) {
  constexpr double kTimeConstant = 2e-3;  // s
  const double share = control::ServoController::kPeriod.seconds() / kTimeConstant;
  filtered_current_ +=
      share * (controller_.actual_current() * kAmperesPerMilliampere - filtered_current_);
  if (homing_capture_.armed()) {
    ReferenceSignals signals = reference_signals(sensing);
    signals.encoder_count = controller_.position();  // of the sensor in use
    homing_capture_.observe(signals, settings_.reference, false, signals.encoder_count);
  }
}

void ServoAxis::configure() {
  const bool other_sensor =
      servo_settings_.controller.commutation != controller_.settings().commutation;
  if (servo_settings_.controller != controller_.settings()) {
    controller_.configure(servo_settings_.controller);
  }
  const double resolution = controller_.increments_per_revolution();
  settings_.units = MotionUnits::rotational(resolution, servo_settings_.controller.maximum_velocity,
                                            servo_settings_.maximum_acceleration);
  const MotionUnits& units = settings_.units;
  settings_.position_end = {.distance = servo_settings_.target_reached_distance,
                            .velocity = units.pps(servo_settings_.target_reached_velocity)};
  settings_.velocity_window = units.pps(servo_settings_.velocity_window);
  if (other_sensor) {
    feedback_.update(controller_.position(), configuration().control_period);
    set_position(0);
    home_offset_display_ = 0;
  }
}

void ServoAxis::set_position(std::int64_t increments) {
  feedback_.set_position(increments);
  motion_.set_position(increments);
}

bool ServoAxis::commutation_known() const {
  return servo_settings_.controller.commutation != ServoCommutation::encoder ||
         controller_.initialised();
}

void ServoAxis::begin_period(base::SimTime /*now*/) {
  configure();
  feedback_.update(controller_.position(), configuration().control_period);
  motion_.advance(configuration().control_period);
  const bool free = !power_.bridge_enabled() || !commutation_known();
  motion_.follow_shaft(
      {.position = feedback_.position(),
       .velocity = actual_velocity(),
       .standstill = settings_.units.pps(servo_settings_.controller.motor_halted_velocity),
       .free = free});
  if (!homing()) {
    filtered_current_ = 0.0;
  }
}

void ServoAxis::supervise_stage(base::SimTime now) {
  update_conditions();
  const auto init_failed = [this] { return power_.bridge_enabled() && controller_.init_error(); };
  const auto shut_down = [this] {
    return conditions_.shutdown_switch &&
           (power_.bridge_enabled() || causes().has(AxisError::shutdown_switch));
  };
  // A short is remembered; its cause went away with the current and cannot hold up a reset.
  AxisErrors present =
      (stage_errors_ & kStageConditionErrors) | (stage_errors_ & kShortErrors).without(errors());
  present.set(AxisError::initialisation_error, init_failed());
  present.set(AxisError::overload, controller_.i2t_exceeded());
  present.set(AxisError::shutdown_switch, shut_down());
  if (nothing_new(kWatched, present)) {
    return;
  }
  // One by one: what the first leads to, the others see.
  for (const AxisError error : kStageConditions) {
    watch(error, stage_errors_.has(error), now);
  }
  for (const AxisError error : kShorts) {
    watch(error, stage_errors_.has(error) && !errors().has(error), now);
  }
  watch(AxisError::initialisation_error, init_failed(), now);
  watch(AxisError::overload, controller_.i2t_exceeded(), now);
  watch(AxisError::shutdown_switch, shut_down(), now);
}

void ServoAxis::update_conditions() {
  const ServoLimits& limits = servo_settings_.limits;
  const auto above = [this](AxisError error, double value, double limit, double hysteresis) {
    stage_errors_.set(error, value > limit - (stage_errors_.has(error) ? hysteresis : 0.0));
  };
  above(AxisError::overvoltage, supply_voltage_, limits.overvoltage, limits.voltage_hysteresis);
  above(AxisError::undervoltage, -supply_voltage_, -limits.undervoltage, limits.voltage_hysteresis);
  above(AxisError::over_temperature_warning, driver_temperature_, limits.warning_temperature,
        limits.temperature_hysteresis);
  above(AxisError::over_temperature, driver_temperature_, limits.shutdown_temperature,
        limits.temperature_hysteresis);
  const bool halls_used = servo_settings_.controller.commutation == ServoCommutation::hall ||
                          controller_.initialising();
  stage_errors_.set(AxisError::hall_error, halls_used && controller_.hall_error());
  controller_.clear_hall_error();
}

void ServoAxis::fault_was_reset() {
  for (const AxisError error : kShorts) {
    stage_errors_.set(error, false);
  }
  if (controller_.init_error()) {
    controller_.forget_initialisation();
  }
}

void ServoAxis::end_period() {
  using control::ServoLoop;
  if (homings() != homings_) {
    homings_ = homings();
    home_offset_display_ = controller_.position() - feedback_.position();
  }
  if (motion_.takeovers() != takeovers_) {
    takeovers_ = motion_.takeovers();
    if (controller_.torque_limited()) {
      controller_.forget_velocity_error();  // one that holds a load goes on
    }
  }
  const control::RampGenerator& ramp = motion_.ramp();
  set_point_.velocity =
      ramp.velocity() * kSecondsPerMinute / controller_.increments_per_revolution();
  if (!power_.bridge_enabled() || stage_errors_.any_of(kShortErrors)) {
    set_point_.loop = ServoLoop::off;
  } else {
    switch (motion_.loop()) {
      case ControlLoop::position:
        set_point_.loop = ServoLoop::position;
        set_point_.position = ramp.position();
        if (motion_.at_rest()) {
          // The sensor has no fraction of an increment: it would be summed up for ever.
          set_point_.position.fraction = 0.0;
        }
        set_point_.position.microsteps += controller_.position() - feedback_.position();
        break;
      case ControlLoop::velocity:
        set_point_.loop = ServoLoop::velocity;
        break;
      case ControlLoop::torque:
        set_point_.loop = ServoLoop::torque;
        set_point_.torque = motion_.torque().value_or(0.0);
        break;
    }
  }
  update_flags();
}

void ServoAxis::update_flags() {
  using control::ServoLoop;
  const ServoLoop loop = set_point_.loop;
  const bool runs = enabled() && mode() != ModeCode::none;
  flags_.set(ServoFlag::overcurrent, stage_errors_.any_of(kShortErrors));
  flags_.set(ServoFlag::undervoltage, stage_errors_.has(AxisError::undervoltage));
  flags_.set(ServoFlag::overvoltage, stage_errors_.has(AxisError::overvoltage));
  flags_.set(ServoFlag::overtemperature, stage_errors_.has(AxisError::over_temperature));
  flags_.set(ServoFlag::motor_halted, controller_.motor_halted());
  flags_.set(ServoFlag::hall_error, stage_errors_.has(AxisError::hall_error));
  flags_.set(ServoFlag::driver_error, stage_errors_.has(AxisError::overcurrent_high_side));
  flags_.set(ServoFlag::init_error, controller_.init_error());
  flags_.set(ServoFlag::stop_mode, !runs);
  flags_.set(ServoFlag::velocity_mode, runs && loop == ServoLoop::velocity);
  flags_.set(ServoFlag::position_mode, runs && loop == ServoLoop::position);
  flags_.set(ServoFlag::torque_mode, runs && loop == ServoLoop::torque);
  flags_.set(ServoFlag::emergency_stop, conditions_.shutdown_switch);
  flags_.set(ServoFlag::free_running, loop == ServoLoop::off);
  flags_.set(ServoFlag::position_end, loop == ServoLoop::position && at_target());
  flags_.set(ServoFlag::module_initialised, commutation_known());
  flags_.set(ServoFlag::it_exceeded, controller_.i2t_exceeded());
}

bool ServoAxis::at_target() const {
  return motion_.at_rest() &&
         std::llabs(feedback_.position() - motion_.position()) <=
             servo_settings_.target_reached_distance &&
         std::abs(controller_.velocity()) <= servo_settings_.target_reached_velocity;
}

Axis::StageStatus ServoAxis::stage_status() const {
  return {.ready = commutation_known(),
          .closed_loop = true,
          .position_loop = true,
          .current = filtered_current_};
}

double ServoAxis::actual_velocity() const {
  return settings_.units.pps(controller_.velocity());
}

double ServoAxis::torque_current() const {
  return controller_.actual_current() * kAmperesPerMilliampere;
}

bool ServoAxis::voltage_enabled() const {
  return !stage_errors_.has(AxisError::undervoltage) && !stage_errors_.has(AxisError::overvoltage);
}

double ServoAxis::shown_velocity() const {
  return controller_.motor_halted() ? 0.0 : actual_velocity();
}

}  // namespace stator::drive
