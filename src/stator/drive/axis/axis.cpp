#include "stator/drive/axis/axis.hpp"

#include <array>
#include <cmath>

#include "stator/drive/power/control_words.hpp"

namespace stator::drive {

namespace {

int option(const IntegerObject& object) {
  return static_cast<int>(object.get());
}

}  // namespace

Axis::Axis(dictionary::Dictionary& dictionary, const AxisConfiguration& configuration,
           base::EventReporter reporter)
    : reporter_(reporter),
      objects_(dictionary, configuration.profile_offset),
      power_(reporter, configuration.number),
      motion_(objects_, settings_, conditions_, configuration.control_period),
      configuration_(configuration) {
  const auto at = [&](unsigned index) {
    return static_cast<std::uint16_t>(index + configuration.profile_offset);
  };
  using Hook = dictionary::Entry::WrittenHook;
  dictionary.on_written(at(0x6040), 0, Hook::bind<&Axis::note_controlword>(*this));
  dictionary.on_written(at(0x6060), 0, Hook::bind<&Axis::note_mode>(*this));
  for (const unsigned target : {0x6071U, 0x607AU, 0x60B0U, 0x60B1U, 0x60B2U, 0x60FFU}) {
    if (dictionary.find(at(target), 0) != nullptr) {
      dictionary.on_written(at(target), 0, Hook::bind<&Axis::note_target>(*this));
    }
  }
  for (std::size_t i = 0; i < kAxisErrorCount; ++i) {
    const auto error = static_cast<AxisError>(i);
    fault_errors_.set(error, is_fault(error));
    warning_errors_.set(error, reaction_to(error) == ErrorReaction::warning);
  }
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
  leaving_mode_ = enabled_ && !motion_.settled();
  if (leaving_mode_) {
    if (!motion_.stopping()) {
      motion_.brake(Braking::slow_down_ramp);
    }
    mode_written_ = true;  // the new mode takes over when the motor stands
    return;
  }
  mode_ = &mode_of(wanted);
  objects_.mode_display.set(static_cast<std::int8_t>(wanted));
  if (enabled_) {
    enter_mode(now, false);
  }
}

void Axis::enter_mode(base::SimTime now, bool behind_stop) {
  stalled_ = false;
  halted_ = halt_wanted();
  motion_.settle(behind_stop || halted_);
  mode_->enter(context(now));
  if (!halted_) {
    mode_->start(context(now));
  }
}

bool Axis::halt_wanted() const {
  const bool looked_at = mode_ != &homing_ || settings_.behaviour.homing_by_profile;
  const bool halt = (controlword_ & controlword::kHalt) != 0 && looked_at;
  return enabled_ && (halt || !stage_status().ready);
}

OperatingMode& Axis::mode_of(ModeCode code) {
  const std::array<OperatingMode*, 7> modes{
      &profile_position_, &profile_velocity_, &profile_torque_, &homing_,
      &cyclic_position_,  &cyclic_velocity_,  &cyclic_torque_};
  const std::uint32_t number = static_cast<std::uint32_t>(code) - 1U;  // of the bit in 6502h
  if (objects_.supported_modes.exists() &&
      (number > 31 || (objects_.supported_modes.get() >> number & 1U) == 0)) {
    return no_mode_;
  }
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
    fault_was_reset();
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
    enter_mode(now, taken_back);
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
    mode_->halt(context(now));
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

void Axis::network_stopped(base::SimTime now) {
  if (power_.state() == PowerState::operation_enabled) {
    power_.raise_fault(power_input(now));
    follow_power_state(now);
  }
  conditions_.network_operational = false;
  publish_statusword(now);
}

void Axis::initialise_position() {
  if (objects_.uses_encoder() && settings_.position_from_encoder && motion_.stands()) {
    motion_.set_position(feedback_.position());
  }
}

void Axis::tick(base::SimTime now) {
  begin_period(now);
  apply(now);
  supervise(now);
  power_.update(power_input(now));
  follow_power_state(now);
  follow_halt(now);
  motion_.supervise();
  mode_->tick(context(now));
  publish(now);
  end_period();
}

void Axis::follow_limit_switches(const SwitchLevels& levels) {
  left_switch_ = levels.left;
  right_switch_ = levels.right;
  conditions_.set_switches(settings_.reference.switches.pressed(levels));
  motion_.obey_limit_switches();
}

PowerInput Axis::power_input(base::SimTime now) const {
  return {.now = now,
          .operation_permitted = conditions_.network_operational,
          .at_rest = motion_.stands() || !power_.bridge_enabled(),
          .fault_present = fault_present(),
          .options = {.quick_stop = option(objects_.quick_stop_option),
                      .shutdown = option(objects_.shutdown_option),
                      .disable_operation = option(objects_.disable_operation_option),
                      .fault_reaction = option(objects_.fault_reaction_option)},
          .delays = settings_.delays};
}

ModeContext Axis::context(base::SimTime now) {
  const StageStatus stage = stage_status();
  return {.objects = objects_,
          .settings = settings_,
          .conditions = conditions_,
          .motion = motion_,
          .feedback = feedback_,
          .capture = homing_capture_,
          .reporter = reporter_,
          .axis = configuration_.number,
          .now = now,
          .enabled = enabled_ && !halted_ && !mode_written_ && !stall_blocks(),
          .halted = halted_,
          .ready = stage.ready,
          .following_error = errors_.has(AxisError::following_error),
          .closed_loop = stage.closed_loop,
          .position_loop = stage.position_loop,
          .motor_current = stage.current,
          .actual_velocity = actual_velocity()};
}

std::int64_t Axis::actual_position() const {
  return objects_.uses_encoder() ? feedback_.position() : motion_.position();
}

void Axis::publish(base::SimTime now) {
  const auto actual = static_cast<std::int32_t>(motion_.scaled(actual_position()));
  objects_.position_demand.set(static_cast<std::int32_t>(motion_.scaled(motion_.position())));
  objects_.position_internal.set(actual);
  objects_.position_actual.set(actual);
  objects_.following_error.set(static_cast<std::int32_t>(motion_.scaled(motion_.position()) -
                                                         motion_.scaled(actual_position())));
  objects_.velocity_demand.set(settings_.velocity_object(motion_.velocity()));
  objects_.velocity_actual.set(settings_.velocity_object(actual_velocity()));
  objects_.torque_actual.set(static_cast<std::int64_t>(
      std::floor(torque_current() * settings_.torque_unit.per_ampere + 0.5)));
  publish_statusword(now);
}

void Axis::publish_statusword(base::SimTime now) {
  const double velocity = shown_velocity();
  if (velocity != 0.0) {
    negative_direction_ = velocity < 0.0;
  }
  std::uint16_t word = statusword_of(power_.state());
  const auto set = [&word](std::uint16_t bit, bool value) {
    word = static_cast<std::uint16_t>(value ? word | bit : word & ~bit);
  };
  set(statusword::kVoltageEnabled, voltage_enabled());
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
