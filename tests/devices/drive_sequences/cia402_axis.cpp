#include "devices/drive_sequences/cia402_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stator/drive/power/control_words.hpp"

namespace stator::tests {

namespace {

using drive::AxisError;
using drive::PowerCommand;
using drive::PowerState;

constexpr double kAtOnce = std::numeric_limits<double>::infinity();

bool halts(const drive::Axis& axis, const Cia402Choices& choices) {
  return (axis.objects().controlword.get() & drive::controlword::kHalt) != 0 &&
         (axis.mode() != drive::ModeCode::homing || choices.halts_homing);
}

struct Ramps {
  double slow_down = 0.0;
  double quick_stop = 0.0;

  [[nodiscard]] StopState by(StopCause cause, std::int64_t option) const {
    switch (option) {
      case 0:
        return {.cause = cause, .unbounded = true};
      case 1:
      case 5:
        return {.cause = cause, .deceleration = slow_down, .unbounded = slow_down <= 0.0};
      case 2:
      case 6:
        return {.cause = cause, .deceleration = quick_stop, .unbounded = quick_stop <= 0.0};
      default:
        return {.cause = cause, .deceleration = kAtOnce};
    }
  }
};

StopState stop_of(const drive::Axis& axis, const Cia402Choices& choices, const Ramps& ramps) {
  const drive::AxisObjects& objects = axis.objects();
  const bool torque = axis.mode() == drive::ModeCode::profile_torque ||
                      axis.mode() == drive::ModeCode::cyclic_synchronous_torque;
  const bool remote = (objects.statusword.get() & drive::statusword::kRemote) != 0;
  switch (axis.power_state()) {
    case PowerState::quick_stop_active:
      // 605Ah says how a quick stop is made that the master commands.
      return drive::command_of(objects.controlword.get()) == PowerCommand::quick_stop
                 ? ramps.by(StopCause::quick_stop, objects.quick_stop_option.get())
                 // Also a quick stop that stays, of a master that has gone on to another command.
                 : StopState{.cause = objects.quick_stop_option.get() >= 5 && remote
                                          ? StopCause::quick_stop
                                          : StopCause::network,
                             .deceleration = std::min(ramps.quick_stop, ramps.slow_down),
                             .unbounded = ramps.quick_stop <= 0.0 || ramps.slow_down <= 0.0};
    case PowerState::fault_reaction_active:
      return ramps.by(StopCause::fault_reaction, objects.fault_reaction_option.get());
    case PowerState::operation_enabled:
      break;
    default:
      return {};
  }
  switch (drive::command_of(objects.controlword.get())) {
    case PowerCommand::switch_on:
      return ramps.by(StopCause::disable_operation, objects.disable_operation_option.get());
    case PowerCommand::shutdown:
      return ramps.by(StopCause::shutdown, objects.shutdown_option.get());
    case PowerCommand::quick_stop:
      return ramps.by(StopCause::quick_stop, objects.quick_stop_option.get());
    case PowerCommand::disable_voltage:
      return ramps.by(StopCause::shutdown, 0);
    default:
      break;
  }
  if (halts(axis, choices)) {
    return torque && choices.halt_releases_torque
               ? StopState{.cause = StopCause::halt, .unbounded = true}
               : ramps.by(StopCause::halt, std::max<std::int64_t>(objects.halt_option.get(), 1));
  }
  if (objects.mode.get() != objects.mode_display.get()) {
    return ramps.by(StopCause::mode_change, 1);
  }
  return {};
}

double acceleration(const drive::Axis& axis, const Cia402Choices& choices, std::uint32_t object) {
  return axis.settings().units.acceleration(object) / choices.counts;
}

Ramps ramps_of(const drive::Axis& axis, const Cia402Choices& choices, bool homed) {
  const drive::AxisObjects& objects = axis.objects();
  Ramps ramps{.slow_down = acceleration(axis, choices, objects.profile_deceleration.get()),
              .quick_stop = acceleration(axis, choices, objects.quick_stop_deceleration.get())};
  if (homed) {
    ramps.slow_down =
        std::min(ramps.slow_down, acceleration(axis, choices, objects.homing_acceleration.get()));
  }
  return ramps;
}

Guidance guidance_of(drive::ModeCode mode) {
  switch (mode) {
    case drive::ModeCode::cyclic_synchronous_position:
    case drive::ModeCode::cyclic_synchronous_velocity:
      return Guidance::cyclic;
    case drive::ModeCode::cyclic_synchronous_torque:
    case drive::ModeCode::profile_torque:
      return Guidance::torque;
    default:
      return Guidance::ramp;
  }
}

void observe_values(const drive::Axis& axis, const Cia402Choices& choices, Sample& sample) {
  const drive::AxisObjects& objects = axis.objects();
  const double sign = axis.settings().velocity_reversed ? -1.0 : 1.0;
  sample.demand = static_cast<double>(axis.motion().position()) / choices.counts;
  sample.demand_velocity = axis.motion().velocity() / choices.counts;
  sample.shown_position = static_cast<double>(objects.position_actual.get()) / choices.counts;
  sample.shown_velocity =
      sign * axis.settings().units.pps(static_cast<double>(objects.velocity_actual.get())) /
      choices.counts;
}

void observe_limits(const drive::Axis& axis, const Cia402Choices& choices, const Ramps& ramps,
                    Sample& sample) {
  const drive::AxisObjects& objects = axis.objects();
  const double speed_up = acceleration(
      axis, choices,
      sample.searching ? objects.homing_acceleration.get() : objects.profile_acceleration.get());
  const double slow_down = acceleration(axis, choices, objects.profile_deceleration.get());
  const bool at_once = speed_up <= 0.0 || ramps.slow_down <= 0.0;
  sample.acceleration = at_once ? kAtOnce : std::max(speed_up, slow_down);
  if (sample.stop.cause != StopCause::none) {
    sample.acceleration = std::max(sample.acceleration, ramps.quick_stop);
  }
  sample.limit_deceleration = ramps.slow_down > 0.0 ? ramps.slow_down : kAtOnce;
  sample.switch_deceleration =
      choices.switch_deceleration > 0.0 ? choices.switch_deceleration : sample.limit_deceleration;
  if (sample.searching) {
    return;  // no limit means anything yet
  }
  if (const auto lower = axis.motion().lower_limit()) {
    sample.lower_limit = static_cast<double>(*lower) / choices.counts;
  }
  if (const auto upper = axis.motion().upper_limit()) {
    sample.upper_limit = static_cast<double>(*upper) / choices.counts;
  }
}

/// Half the window of 6067h; a product without monitoring there may say itself what the end is.
double window_of(const drive::Axis& axis) {
  const std::uint32_t window = axis.objects().position_window.get();
  if (window != 0xFFFFFFFF) {
    return window;
  }
  const auto& end = axis.settings().position_end;
  return end ? static_cast<double>(end->distance) : 0.0;
}

void observe_target(const drive::Axis& axis, const Cia402Choices& choices, Sample& sample) {
  const drive::AxisObjects& objects = axis.objects();
  const drive::AxisSettings& settings = axis.settings();
  const control::RampGenerator& ramp = axis.motion().ramp();
  const drive::ModeCode mode = axis.mode();
  const double counts = choices.counts;
  sample.target = mode == drive::ModeCode::cyclic_synchronous_position
                      ? static_cast<double>(objects.target_position.get()) / counts
                      : static_cast<double>(ramp.target_position()) / counts;
  const double largest = settings.units.maximum_velocity();
  sample.target_velocity =
      std::clamp(settings.velocity_of(objects.target_velocity.get()), -largest, largest) / counts;
  sample.window = (window_of(axis) + 1.0) / counts;
  sample.velocity_window = settings.velocity_window / counts;
  const double end =
      settings.units.velocity(std::abs(static_cast<double>(objects.end_velocity.get())));
  sample.end_velocity = choices.steps_to_rest ? end / counts : 0.0;
  const bool positions = mode == drive::ModeCode::profile_position && end == 0.0 &&
                         ramp.mode() == control::RampMode::position;
  sample.target_reached_bit = sample.enabled && sample.stop.cause == StopCause::none &&
                              (mode == drive::ModeCode::profile_velocity || positions);
}

}  // namespace

PowerOff power_off_by(const drive::Axis& axis) {
  const drive::AxisObjects& objects = axis.objects();
  const PowerCommand command = drive::command_of(objects.controlword.get());
  if (command == PowerCommand::disable_voltage) {
    return PowerOff::disable_voltage;
  }
  const bool faulty = axis.power_state() == PowerState::fault ||
                      axis.power_state() == PowerState::fault_reaction_active;
  if ((command == PowerCommand::shutdown && objects.shutdown_option.get() == 0) ||
      (command == PowerCommand::switch_on && objects.disable_operation_option.get() == 0) ||
      (command == PowerCommand::quick_stop && objects.quick_stop_option.get() == 0) ||
      (faulty && objects.fault_reaction_option.get() == 0)) {
    return PowerOff::option_0;
  }
  constexpr drive::AxisErrors kStage{
      AxisError::undervoltage,         AxisError::overvoltage,     AxisError::overcurrent_a,
      AxisError::overcurrent_b,        AxisError::overcurrent_c,   AxisError::overcurrent_high_side,
      AxisError::over_temperature,     AxisError::shutdown_switch, AxisError::hall_error,
      AxisError::initialisation_error, AxisError::driver_error};
  return axis.errors().any_of(kStage) ? PowerOff::stage_fault : PowerOff::not_allowed;
}

void Cia402Observer::observe(const drive::Axis& axis, const Cia402Choices& choices,
                             Sample& sample) {
  const drive::AxisObjects& objects = axis.objects();
  const bool homes = axis.mode() == drive::ModeCode::homing;
  homed_ = homes || homed_;
  const Ramps ramps = ramps_of(axis, choices, homed_);
  sample.statusword = objects.statusword.get();
  sample.mode = static_cast<int>(axis.mode());
  sample.power = axis.bridge_enabled();
  sample.guidance = guidance_of(axis.mode());
  sample.stop = stop_of(axis, choices, ramps);
  homed_ = homes || (homed_ && sample.stop.cause != StopCause::none);
  sample.enabled = axis.power_state() == PowerState::operation_enabled;
  sample.searching = homes;
  observe_values(axis, choices, sample);
  observe_limits(axis, choices, ramps, sample);
  observe_target(axis, choices, sample);
  sample.follows_bit = sample.guidance == Guidance::cyclic;
  sample.power_off = power_off_by(axis);
  // Transitions 7, 9, 10 and 12; a fault reaction ends first.
  sample.has_to_be_off =
      drive::command_of(objects.controlword.get()) == PowerCommand::disable_voltage &&
      axis.power_state() != PowerState::fault_reaction_active;
  sample.position_renamed = homings_ != axis.homings() || sample.searching;
  sample.reference_changed =
      homings_ != axis.homings() || mode_ != axis.mode() || powered_ != axis.bridge_enabled();
  homings_ = axis.homings();
  mode_ = axis.mode();
  powered_ = axis.bridge_enabled();
}

}  // namespace stator::tests
