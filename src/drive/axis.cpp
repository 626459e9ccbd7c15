#include "drive/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "drive/control_words.hpp"

namespace stator::drive {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;

// {0} axis, {1} actual position, {2} demand or limit.
constexpr std::array<EventRule, kAxisErrorCount> kErrorRules{{
    {"axis-following-error", Severity::fault,
     "axis {0}: following error: actual position {1}, demand {2}, further apart than 6065h allows; "
     "look for a blocked shaft or a velocity the motor cannot reach, then reset the fault"},
    {"axis-positive-software-limit", Severity::warning,
     "axis {0}: actual position {1} is beyond the positive software limit {2}; move back"},
    {"axis-negative-software-limit", Severity::warning,
     "axis {0}: actual position {1} is beyond the negative software limit {2}; move back"},
    {"axis-positive-limit-switch", Severity::warning,
     "axis {0}: positive limit switch touched at position {1}; motion is possible in negative "
     "direction only, or with the switch deactivated"},
    {"axis-negative-limit-switch", Severity::warning,
     "axis {0}: negative limit switch touched at position {1}; motion is possible in positive "
     "direction only, or with the switch deactivated"},
    {"axis-stall", Severity::warning,
     "axis {0}: stopped at position {1}: the load measurement fell to 0 above the speed of the "
     "stop "
     "on stall; look for a blocked shaft, or raise current or stall threshold, then move again"},
    {"axis-open-load-a", Severity::warning,
     "axis {0}: no current flows in phase A; look for a broken motor cable"},
    {"axis-open-load-b", Severity::warning,
     "axis {0}: no current flows in phase B; look for a broken motor cable"},
    {"axis-overcurrent-a", Severity::fault,
     "axis {0}: overcurrent in bridge A, the driver is switched off; look for a short in motor or "
     "cable, then reset the fault"},
    {"axis-overcurrent-b", Severity::fault,
     "axis {0}: overcurrent in bridge B, the driver is switched off; look for a short in motor or "
     "cable, then reset the fault"},
    {"axis-overcurrent-high-side", Severity::fault,
     "axis {0}: overcurrent on the high side, the driver is switched off; look for a short in the "
     "driver stage, then reset the fault"},
    {"axis-over-temperature-warning", Severity::warning,
     "axis {0}: the driver is near its temperature limit; lower the current or cool the module"},
    {"axis-over-temperature", Severity::fault,
     "axis {0}: the driver is too hot and has been switched off; let it cool, then reset the "
     "fault"},
    {"axis-undervoltage", Severity::fault,
     "axis {0}: the supply is too low to drive a motor; restore it, then reset the fault"},
    {"axis-shutdown-switch", Severity::fault,
     "axis {0}: the shutdown switch is active, the driver is switched off; release it, then reset "
     "the fault"},
}};

/// Everything that supervise_driver() watches.
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

std::int16_t milliamperes(double amperes) {
  return static_cast<std::int16_t>(std::clamp(std::floor(amperes * 1e3 + 0.5), -32768.0, 32767.0));
}

}  // namespace

Axis::Axis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
           base::EventReporter reporter)
    : configuration_(configuration),
      reporter_(reporter),
      objects_(dictionary, configuration.profile_offset),
      power_(reporter, configuration.number),
      motion_(objects_, settings_, conditions_),
      closed_loop_conditions_(reporter, configuration.number) {
  const auto at = [&](unsigned index) {
    return static_cast<std::uint16_t>(index + configuration.profile_offset);
  };
  using Hook = dictionary::Entry::WrittenHook;
  dictionary.on_written(at(0x6040), 0, Hook::bind<&Axis::note_controlword>(*this));
  dictionary.on_written(at(0x6060), 0, Hook::bind<&Axis::note_mode>(*this));
  for (const unsigned target : {0x6071U, 0x607AU, 0x60B0U, 0x60B1U, 0x60B2U, 0x60FFU}) {
    dictionary.on_written(at(target), 0, Hook::bind<&Axis::note_target>(*this));
  }
  for (std::size_t i = 0; i < kAxisErrorCount; ++i) {
    const auto error = static_cast<AxisError>(i);
    fault_errors_.set(error, is_fault(error));
    warning_errors_.set(error, reaction_to(error) == ErrorReaction::warning);
  }
  update_feedback();
  publish(base::SimTime());
}

void Axis::apply(base::SimTime now) {
  if (!has_commands()) {
    return;
  }
  take_mode(now);
  if (controlword_written_) {
    take_controlword(now);
  }
  if (target_written_) {
    target_written_ = false;
    if (const ModeContext present = context(now); present.enabled) {
      mode_->on_target(present);
    }
  }
  publish_statusword(now);
}

void Axis::take_controlword(base::SimTime now) {
  controlword_written_ = false;
  const std::uint16_t previous = controlword_;
  controlword_ = objects_.controlword.get();
  power_.command(controlword_, power_input(now));
  follow_power_state(now);
  follow_halt(now);
  mode_->on_controlword(context(now), previous, controlword_);
}

void Axis::take_mode(base::SimTime now) {
  const auto wanted = static_cast<ModeCode>(objects_.mode.get());
  mode_written_ = false;
  if (wanted == mode_->code() && !leaving_mode_) {
    return;
  }
  leaving_mode_ = enabled_ && !motion_.at_rest();
  if (leaving_mode_) {
    if (motion_.ramp().mode() != control::RampMode::stop) {
      motion_.brake(Braking::slow_down_ramp);
    }
    mode_written_ = true;  // the new mode takes over when the motor stands
    return;
  }
  mode_ = &mode_of(wanted);
  objects_.mode_display.set(static_cast<std::int8_t>(wanted));
  if (enabled_) {
    enter_mode(now);
  }
}

void Axis::enter_mode(base::SimTime now) {
  stalled_ = false;
  halted_ = halt_wanted();
  mode_->enter(context(now));
  if (!halted_) {
    mode_->start(context(now));
  }
}

bool Axis::halt_wanted() const {
  return enabled_ && (controlword_ & controlword::kHalt) != 0 && mode_->code() != ModeCode::homing;
}

OperatingMode& Axis::mode_of(ModeCode code) {
  const std::array<OperatingMode*, 6> modes{&profile_position_, &profile_velocity_,
                                            &homing_,           &cyclic_position_,
                                            &cyclic_velocity_,  &cyclic_torque_};
  for (OperatingMode* mode : modes) {
    if (mode->code() == code) {
      return *mode;
    }
  }
  return no_mode_;
}

void Axis::follow_power_state(base::SimTime now) {
  if (power_.fault_resets() != fault_resets_) {
    fault_resets_ = power_.fault_resets();
    errors_ = causes_;
    driver_.clear_shorts();
  }
  // Transition 16: the bridge has been on all the time, the demand position still counts.
  const bool taken_back =
      braking_ == Braking::slow_down_ramp || braking_ == Braking::quick_stop_ramp;
  if (power_.braking() != braking_) {
    braking_ = power_.braking();
    motion_.brake(braking_);
  }
  const bool enabled = power_.drive_function_enabled();
  if (enabled == enabled_) {
    return;
  }
  enabled_ = enabled;
  halted_ = false;
  if (enabled_) {
    if (!taken_back) {
      initialise_position();
    }
    enter_mode(now);
  }
}

void Axis::follow_halt(base::SimTime now) {
  const bool wanted = halt_wanted();
  if (wanted == halted_) {
    return;
  }
  halted_ = wanted;
  if (halted_) {
    stalled_ = false;
    motion_.brake(Braking::slow_down_ramp);
  } else if (enabled_) {
    mode_->resume(context(now));
  }
}

void Axis::network_left_operational(base::SimTime now) {
  conditions_.network_operational = false;
  power_.network_left_operational(power_input(now));
  follow_power_state(now);
  publish_statusword(now);
}

void Axis::initialise_position() {
  if (objects_.uses_encoder() && settings_.position_from_encoder) {
    motion_.set_position(feedback_.position());
  }
}

void Axis::tick(base::SimTime now) {
  update_feedback();
  feedback_.update(encoder_count_, configuration_.control_period);
  supervise_closed_loop(now);
  apply(now);
  supervise(now);
  power_.update(power_input(now));
  follow_power_state(now);
  motion_.supervise(configuration_.control_period);
  mode_->tick(context(now));
  publish(now);
}

void Axis::supervise_closed_loop(base::SimTime now) {
  stage_.configure(settings_.closed_loop, encoder_scale(objects_, settings_));
  closed_loop_wanted_ = closed_loop_conditions_.fulfilled(objects_, settings_, now);
  closed_loop_conditions_.explain_torque(enabled_ &&
                                             mode_->code() == ModeCode::cyclic_synchronous_torque &&
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

void Axis::follow_rotor() {
  const unsigned shift =
      settings_.microstep_resolution < 8 ? 8U - settings_.microstep_resolution : 0U;
  const double microstep = 1.0 / static_cast<double>(1U << shift);
  motion_.follow_rotor(stage_.closed_loop().deviation() * microstep,
                       stage_.closed_loop().rotor().velocity() * microstep);
}

void Axis::update_feedback() {
  feedback_.set_scale(objects_.encoder_increments.get(), settings_.microsteps_per_revolution,
                      settings_.encoder_reversed);
}

void Axis::supervise(base::SimTime now) {
  const std::int64_t actual = actual_position();
  const std::int64_t deviation = actual - motion_.position();
  const std::int64_t window = objects_.following_window.get();
  const bool under_power = power_.bridge_enabled();
  watch(AxisError::following_error,
        under_power && objects_.uses_encoder() && window > 0 && !motion_.torque() &&
            std::abs(deviation) > window,
        now);

  const bool homes = mode_->code() == ModeCode::homing;  // no limit means anything yet
  const auto upper = motion_.upper_limit();
  const auto lower = motion_.lower_limit();
  watch(AxisError::positive_software_limit, upper && actual > *upper && !homes, now);
  watch(AxisError::negative_software_limit, lower && actual < *lower && !homes, now);
  watch(AxisError::positive_limit_switch, conditions_.positive_limit_switch && !homes, now);
  watch(AxisError::negative_limit_switch, conditions_.negative_limit_switch && !homes, now);
  supervise_driver(now);
}

void Axis::supervise_driver(base::SimTime now) {
  driver_.supervise(settings_.driver.limits);
  if (motion_.velocity() != 0.0 || !power_.bridge_enabled()) {
    stalled_ = false;
  }
  const AxisErrors flags = driver_.flags();
  if (flags.empty() && !causes_.any_of(kDriverErrors) && !conditions_.shutdown_switch && !stalled_)
      [[likely]] {
    return;
  }
  for (const AxisError error : kDriverConditions) {
    watch(error, flags.has(error), now);
  }
  // The chip remembers a short; its cause went away with the current and cannot hold up a reset.
  for (const AxisError error : kShorts) {
    watch(error, flags.has(error) && !errors_.has(error), now);
  }
  watch(AxisError::shutdown_switch, conditions_.shutdown_switch, now);
  watch(AxisError::stall, stalled_, now);
}

void Axis::stop_on_stall() {
  stalled_ = true;
  motion_.brake(Braking::at_once);
}

bool Axis::stall_blocks() const {
  // A master that goes on sending cyclic targets must not drive the motor into the obstacle again.
  return stalled_ && (mode_ == &cyclic_position_ || mode_ == &cyclic_velocity_);
}

void Axis::watch(AxisError error, bool present, base::SimTime now) {
  const bool appears = present && !causes_.has(error);
  causes_.set(error, present);
  if (!present && !is_fault(error)) {
    errors_.set(error, false);
  }
  if (!appears || errors_.has(error)) {
    return;
  }
  errors_.set(error, true);
  const std::int64_t reference =
      error == AxisError::positive_software_limit   ? motion_.upper_limit().value_or(0)
      : error == AxisError::negative_software_limit ? motion_.lower_limit().value_or(0)
                                                    : motion_.position();
  reporter_.report(now, kErrorRules[static_cast<std::size_t>(error)],
                   {EventArgument(int{configuration_.number}), EventArgument(actual_position()),
                    EventArgument(reference)});
  if (is_fault(error)) {
    power_.raise_fault(power_input(now), reaction_to(error) == ErrorReaction::power_off);
  }
}

ErrorReaction Axis::reaction_to(AxisError error) const {
  return configuration_.reactions[static_cast<std::size_t>(error)];
}

bool Axis::is_fault(AxisError error) const {
  return reaction_to(error) == ErrorReaction::fault ||
         reaction_to(error) == ErrorReaction::power_off;
}

bool Axis::fault_present() const {
  return causes_.any_of(fault_errors_);
}

bool Axis::warning_present() const {
  return causes_.any_of(warning_errors_);
}

base::AxisActuation Axis::step(base::SimDuration duration, const base::AxisSensing& sensing) {
  encoder_count_ = sensing.encoder_count;
  coil_current_ = sensing.coil_current;
  if (homing_capture_.armed() || index_latch_.armed()) [[unlikely]] {
    capture_positions(sensing);
  }
  motion_.advance(duration);
  settings_.currents.cool_step_reduction = driver_.current_reduction();
  base::AxisActuation actuation = stage_.advance(motion_.ramp(), settings_, sensing,
                                                 {.bridge_enabled = power_.bridge_enabled(),
                                                  .brake_released = power_.brake_released(),
                                                  .operation_enabled = enabled_,
                                                  .closed_loop = closed_loop_wanted_,
                                                  .torque = motion_.torque()},
                                                 duration);
  driver_.advance(settings_, motion_.velocity(), actuation, sensing);
  if (driver_.take_stall()) {
    stop_on_stall();
  }
  return actuation;
}

void Axis::capture_positions(const base::AxisSensing& sensing) {
  const std::int64_t motor = motion_.ramp().motor_microsteps();
  for (PositionCapture* capture : {&homing_capture_, &index_latch_}) {
    capture->observe(sensing, settings_.reference, objects_.uses_encoder(), motor);
  }
}

void Axis::arm_index_latch(bool armed) {
  if (armed) {
    index_latch_.arm_index();
  } else {
    index_latch_.disarm();
  }
}

std::optional<Axis::LatchedPositions> Axis::take_index_latch() {
  const std::optional<CapturedPosition> captured = index_latch_.take();
  if (!captured) {
    return std::nullopt;
  }
  return LatchedPositions{.demand = motion_.position_of(captured->motor_microsteps),
                          .encoder = feedback_.position_at(captured->encoder_count)};
}

PowerInput Axis::power_input(base::SimTime now) const {
  return {.now = now,
          .operation_permitted = conditions_.network_operational,
          .at_rest = motion_.at_rest(),
          .fault_present = fault_present(),
          .options = {.quick_stop = objects_.quick_stop_option.get(),
                      .shutdown = objects_.shutdown_option.get(),
                      .disable_operation = objects_.disable_operation_option.get(),
                      .fault_reaction = objects_.fault_reaction_option.get()},
          .delays = settings_.delays};
}

ModeContext Axis::context(base::SimTime now) {
  return {.objects = objects_,
          .settings = settings_,
          .conditions = conditions_,
          .motion = motion_,
          .feedback = feedback_,
          .capture = homing_capture_,
          .now = now,
          .enabled = enabled_ && !halted_ && !mode_written_ && !stall_blocks(),
          .halted = halted_,
          .following_error = errors_.has(AxisError::following_error),
          .closed_loop = stage_.closed_loop().active()};
}

std::int64_t Axis::actual_position() const {
  return objects_.uses_encoder() ? feedback_.position() : motion_.position();
}

double Axis::actual_velocity() const {
  return objects_.uses_encoder() ? feedback_.velocity() : motion_.velocity();
}

void Axis::publish(base::SimTime now) {
  const auto actual = static_cast<std::int32_t>(actual_position());
  objects_.position_demand.set(static_cast<std::int32_t>(motion_.position()));
  objects_.position_internal.set(actual);
  objects_.position_actual.set(actual);
  objects_.velocity_actual.set(settings_.units.velocity_object(actual_velocity()));
  objects_.torque_actual.set(milliamperes(stage_.torque_current(coil_current_)));
  publish_statusword(now);
}

void Axis::publish_statusword(base::SimTime now) {
  const double velocity = motion_.velocity();
  if (velocity != 0.0) {
    negative_direction_ = velocity < 0.0;
  }
  std::uint16_t word = statusword_of(power_.state());
  const auto set = [&word](std::uint16_t bit, bool value) {
    word = static_cast<std::uint16_t>(value ? word | bit : word & ~bit);
  };
  set(statusword::kVoltageEnabled,
      conditions_.supply_present && !driver_.flags().has(AxisError::undervoltage));
  set(statusword::kRemote, conditions_.network_operational);
  set(statusword::kInternalLimit, motion_.limited() ||
                                      errors_.has(AxisError::positive_software_limit) ||
                                      errors_.has(AxisError::negative_software_limit));
  set(statusword::kWarning, warning_present());
  set(statusword::kMotorActivity, velocity != 0.0);
  set(statusword::kNegativeDirection, negative_direction_);
  word = static_cast<std::uint16_t>(word | mode_->status(context(now)));
  objects_.statusword.set(word);
}

}  // namespace stator::drive
