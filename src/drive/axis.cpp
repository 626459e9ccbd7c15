#include "drive/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "drive/control_words.hpp"

namespace stator::drive {

namespace {

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
      motion_(objects_, settings_, conditions_, configuration.control_period),
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
  motion_.supervise();
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

base::AxisActuation Axis::step(base::SimDuration duration, const base::AxisSensing& sensing) {
  encoder_count_ = sensing.encoder_count;
  coil_current_ = sensing.coil_current;
  if (homing_capture_.armed() || index_latch_.armed()) [[unlikely]] {
    capture_positions(sensing);
  }
  if (sensing.left_switch != left_switch_ || sensing.right_switch != right_switch_) [[unlikely]] {
    follow_limit_switches(sensing);
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

/// As a motion controller chip does, the axis stops at a limit switch at once; what its firmware
/// has to say comes with the next control period.
void Axis::follow_limit_switches(const base::AxisSensing& sensing) {
  left_switch_ = sensing.left_switch;
  right_switch_ = sensing.right_switch;
  conditions_.set_switches(settings_.reference.switches.pressed(sensing));
  motion_.obey_limit_switches();
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
  set(statusword::kVoltageEnabled, !driver_.flags().has(AxisError::undervoltage));
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
