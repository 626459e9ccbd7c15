#include "stator/devices/tmcm_142/motion_axis.hpp"

#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::devices::tmcm_142 {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;
using control::motion_controller::kVelocityUnit;
using control::motion_controller::SearchFailure;

constexpr EventRule kDeviation{
    "tmcm142-deviation", Severity::fault,
    "motor stopped at {0}: the encoder (parameter 41) says {1}, further away than parameter 212 "
    "allows, {2} microsteps; motion commands end here until these agree again: write what 41 reads "
    "to parameter 1, or set 212 higher, then command the motion"};
constexpr EventRule kDriverError{"tmcm142-driver-error", Severity::fault,
                                 "power stage off, bit 0 of parameter 26 and ALARM on: {0}"};
constexpr EventRule kUndriven{
    "tmcm142-undriven", Severity::fault,
    "the motor stays at {0}, for its power stage is off ({1}); motion commands given meanwhile are "
    "not made up for: command the motion again afterwards"};
constexpr EventRule kSearchFailed{"tmcm142-search-failed", Severity::fault,
                                  "reference search ended without a reference: {0}"};
constexpr EventRule kLimit{
    "tmcm142-limit", Severity::information,
    "a limit switch or position limit stops the motor at {0}; motion away from it is possible"};
constexpr EventRule kBowTooLarge{
    "tmcm142-bow", Severity::warning,
    "bow index {0} (parameter 18) is so large that acceleration {1} is reached within one step of "
    "the ramp: the chip may oscillate; choose a smaller one"};
constexpr EventRule kCompare{"tmcm142-compare", Severity::information,
                             "position {0} (parameter 48) passed"};

base::StaticText cause_of(const DriverStage& stage) {
  using drive::AxisError;
  if (stage.overvoltage()) {
    return "the supply is above 78.5 V";
  }
  if (stage.flags().has(AxisError::undervoltage)) {
    return "the supply is below 18 V";
  }
  if (stage.flags().has(AxisError::over_temperature)) {
    return "the power stage is too hot";
  }
  return "a motor output is shorted; the stage tries again every 5 ms";
}

base::StaticText text_of(SearchFailure failure) {
  switch (failure) {
    case SearchFailure::deviation:
      return "the encoder deviates from the motor by more than parameter 212";
    case SearchFailure::undriven:
      return "the power stage is off";
    case SearchFailure::no_speed:
      return "its speed is 0 (parameters 194 and 195, or 4 where these are 0)";
    case SearchFailure::none:
      break;
  }
  return "";
}

}  // namespace

MotionAxis::MotionAxis(const plant::StepperAxisParameters& plant, base::EventReporter reporter)
    : reporter_(reporter),
      plant_(plant),
      instruments_(plant_, {plant::AxisPart::limit_switches, plant::AxisPart::home_switch,
                            plant::AxisPart::encoder, plant::AxisPart::driver_thermometer}) {}

void MotionAxis::restart() {
  controller_ = Controller();
  search_ = {};
  stage_.restart();
  driver_error_ = deviation_ = search_failed_ = at_limit_ = shut_down_ = false;
  undriven_ = undriven_told_ = false;
  bow_too_large_ = compare_armed_ = false;
  seen_pulses_ = 0;
}

AxisEvents MotionAxis::step(base::SimTime now, base::SimDuration period,
                            const AxisConditions& conditions) {
  if (!conditions.powered) {
    static_cast<void>(plant_.step({}, period));
    return {};
  }
  AxisEvents events;
  events.shut_down = conditions.shut_down && !shut_down_;
  shut_down_ = conditions.shut_down;
  stand_undriven(now, events);
  base::AxisSensing pins = plant_.sensing();
  pins.left_switch = !pins.left_switch;
  pins.right_switch = !pins.right_switch;
  controller_.advance(pins, period);
  if (search_.active()) {
    search_.advance(controller_);
  }
  const std::int64_t pulses = controller_.step_direction().pulses;
  if (conditions.step_direction_connected && controller_.step_direction().pulse_length > 0) {
    shown_pulses_ += pulses - seen_pulses_;
  }
  seen_pulses_ = pulses;
  const auto microsteps = static_cast<double>(2048 >> controller_.microstep_resolution());
  const StageInput input{
      .enabled = !shut_down_,
      .phases = controller_.table_phases(),
      .scale = controller_.current_scale(),
      .full_steps_per_second = controller_.pid_velocity() * kVelocityUnit / microsteps,
      .standing = controller_.standing(),
      .mixed_decay_run = stage_settings_.mixed_decay_run,
      .mixed_decay_standby = stage_settings_.mixed_decay_standby,
      .chopper_divider = stage_settings_.chopper_divider,
      .resistance = plant_.resistance()};
  static_cast<void>(plant_.step(stage_.advance(input, plant_.sensing(), period), period));
  look_for_events(now, events);
  return events;
}

/// Ends what would move a motor whose stage is off: the ramp would count where no shaft turns.
void MotionAxis::stand_undriven(base::SimTime now, AxisEvents& events) {
  const bool moves = search_.active() || !controller_.at_rest();
  const bool commanded_anew = moves && undriven_;
  undriven_ = shut_down_ || stage_.error();
  if (!undriven_) {
    undriven_told_ = false;
    return;
  }
  search_.abandon(controller_);
  controller_.stop_undriven();
  if (commanded_anew) {
    events.shut_down = events.shut_down || shut_down_;
    events.driver_error = events.driver_error || stage_.error();
  }
  if (moves && !undriven_told_) {
    undriven_told_ = true;
    reporter_.report(
        now, kUndriven,
        {controller_.position(),
         shut_down_ ? base::StaticText("shutdown pin") : base::StaticText("parameter 26, bit 0")});
  }
}

bool MotionAxis::at_limit() const {
  using control::motion_controller::PositionLimits;
  constexpr std::uint32_t kStopConditions = 0x30;  // of parameter 9
  const PositionLimits& limits = controller_.settings().limits;
  return (controller_.switch_status() & kStopConditions) != 0 ||
         (limits.right_enabled && controller_.position() > limits.right) ||
         (limits.left_enabled && controller_.position() < limits.left);
}

void MotionAxis::look_for_events(base::SimTime now, AxisEvents& events) {
  const auto rises = [](bool& seen, bool present) {
    const bool risen = present && !seen;
    seen = present;
    return risen;
  };
  if (rises(driver_error_, stage_.error())) {
    events.driver_error = true;
    reporter_.report(now, kDriverError, {EventArgument(cause_of(stage_))});
  }
  if (rises(deviation_, controller_.stopped_by_deviation())) {
    events.deviation = true;
    reporter_.report(now, kDeviation,
                     {controller_.position(), controller_.encoder_position(),
                      controller_.settings().encoder.maximum_deviation});
  }
  if (rises(search_failed_, search_.failure() != SearchFailure::none)) {
    events.position_error = true;
    reporter_.report(now, kSearchFailed, {EventArgument(text_of(search_.failure()))});
  }
  // Switches that a reference search meets are handled by the search.
  if (rises(at_limit_, at_limit()) && !search_.active()) {
    events.position_error = true;
    reporter_.report(now, kLimit, {controller_.position()});
  }
  if (rises(bow_too_large_, controller_.bow_too_large())) {
    const auto& ramp = controller_.settings().ramp;
    reporter_.report(now, kBowTooLarge, {static_cast<int>(ramp.bow), ramp.acceleration});
  }
  if (compare_armed_) {
    report_compare(now);
  }
}

void MotionAxis::report_compare(base::SimTime now) {
  if ((controller_.position() < compare_position_) != compare_ahead_) {
    compare_armed_ = false;
    reporter_.report(now, kCompare, {compare_position_});
  }
}

void MotionAxis::arm_compare(std::int32_t position) {
  compare_position_ = position;
  compare_ahead_ = controller_.position() < position;
  compare_armed_ = true;
}

/// A search under way ends, and what ends this motion too is told anew.
void MotionAxis::begin_motion() {
  stop_search();
  deviation_ = false;
}

void MotionAxis::move_to(std::int32_t position) {
  begin_motion();
  controller_.move_to(position);
}

void MotionAxis::rotate(std::int32_t velocity) {
  begin_motion();
  controller_.rotate(velocity);
}

void MotionAxis::set_target_velocity(std::int32_t velocity) {
  begin_motion();
  controller_.set_target_velocity(velocity);
}

void MotionAxis::set_mode(control::motion_controller::Mode mode) {
  begin_motion();
  controller_.set_mode(mode);
}

void MotionAxis::start_search(const control::motion_controller::SearchSettings& settings) {
  begin_motion();
  search_failed_ = false;
  search_.start(controller_, settings);
}

void MotionAxis::stop_search() {
  if (search_.active()) {
    search_.stop(controller_);
  }
}

}  // namespace stator::devices::tmcm_142
