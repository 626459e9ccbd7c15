#include "devices/drive_sequences/cia402_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drive/control_words.hpp"

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
  switch (axis.power_state()) {
    case PowerState::quick_stop_active:
      // 605Ah says how a quick stop is made that the master commands.
      return drive::command_of(objects.controlword.get()) == PowerCommand::quick_stop
                 ? ramps.by(StopCause::quick_stop, objects.quick_stop_option.get())
                 : StopState{.cause = StopCause::network,
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

void observe(const drive::Axis& axis, const Cia402Choices& choices, bool& homed, Sample& sample) {
  const drive::AxisObjects& objects = axis.objects();
  const drive::AxisSettings& settings = axis.settings();
  const double counts = choices.counts;
  const auto acceleration = [&](std::uint32_t object) {
    return settings.units.acceleration(object) / counts;
  };
  const double speed_up = acceleration(objects.profile_acceleration.get());
  const double homing = acceleration(objects.homing_acceleration.get());
  Ramps ramps{.slow_down = acceleration(objects.profile_deceleration.get()),
              .quick_stop = acceleration(objects.quick_stop_deceleration.get())};
  const auto mode = axis.mode();
  const bool homes = mode == drive::ModeCode::homing;
  homed = homes || homed;
  if (homed) {
    ramps.slow_down = std::min(ramps.slow_down, homing);
  }

  sample.statusword = objects.statusword.get();
  sample.mode = static_cast<int>(mode);
  sample.power = axis.bridge_enabled();
  sample.guidance = Guidance::ramp;
  if (mode == drive::ModeCode::cyclic_synchronous_position ||
      mode == drive::ModeCode::cyclic_synchronous_velocity) {
    sample.guidance = Guidance::cyclic;
  } else if (mode == drive::ModeCode::cyclic_synchronous_torque ||
             mode == drive::ModeCode::profile_torque) {
    sample.guidance = Guidance::torque;
  }
  sample.stop = stop_of(axis, choices, ramps);
  homed = homes || (homed && sample.stop.cause != StopCause::none);
  sample.enabled = axis.power_state() == PowerState::operation_enabled;
  sample.searching = homes;
  sample.demand = static_cast<double>(axis.motion().position()) / counts;
  sample.demand_velocity = axis.motion().velocity() / counts;
  sample.shown_position = objects.position_actual.get() / counts;
  const double sign = settings.velocity_reversed ? -1.0 : 1.0;
  sample.shown_velocity = sign * settings.units.pps(objects.velocity_actual.get()) / counts;
  sample.acceleration =
      std::max(homes ? homing : speed_up, acceleration(objects.profile_deceleration.get()));
  if (speed_up <= 0.0 || ramps.slow_down <= 0.0) {
    sample.acceleration = kAtOnce;
  }
  if (sample.stop.cause != StopCause::none) {
    sample.acceleration = std::max(sample.acceleration, ramps.quick_stop);
  }
  const double slow = ramps.slow_down > 0.0 ? ramps.slow_down : kAtOnce;
  sample.switch_deceleration =
      choices.switch_deceleration > 0.0 ? choices.switch_deceleration : slow;
  sample.limit_deceleration = slow;
  if (!homes) {
    sample.lower_limit = axis.motion().lower_limit()
                             ? static_cast<double>(*axis.motion().lower_limit()) / counts
                             : -kAtOnce;
    sample.upper_limit = axis.motion().upper_limit()
                             ? static_cast<double>(*axis.motion().upper_limit()) / counts
                             : kAtOnce;
  }
  const bool cyclic_position = mode == drive::ModeCode::cyclic_synchronous_position;
  sample.target = cyclic_position
                      ? objects.target_position.get() / counts
                      : static_cast<double>(axis.motion().ramp().target_position()) / counts;
  const double largest = settings.units.maximum_velocity();
  sample.target_velocity =
      std::clamp(settings.velocity_of(objects.target_velocity.get()), -largest, largest) / counts;
  const std::uint32_t window = objects.position_window.get();
  const bool ends = window == 0xFFFFFFFF && settings.position_end;
  sample.window = ((ends ? static_cast<double>(settings.position_end->distance)
                         : (window == 0xFFFFFFFF ? 0.0 : static_cast<double>(window))) +
                   1.0) /
                  counts;
  sample.velocity_window = settings.velocity_window / counts;
  sample.end_velocity =
      choices.steps_to_rest
          ? settings.units.velocity(std::abs(static_cast<double>(objects.end_velocity.get()))) /
                counts
          : 0.0;
  sample.target_reached_bit =
      sample.enabled && sample.stop.cause == StopCause::none &&
      (mode == drive::ModeCode::profile_velocity ||
       (mode == drive::ModeCode::profile_position && objects.end_velocity.get() == 0 &&
        axis.motion().ramp().mode() == control::RampMode::position));
  sample.follows_bit = sample.guidance == Guidance::cyclic;
  sample.power_off = power_off_by(axis);
  // Transitions 7, 9, 10 and 12; a fault reaction ends first.
  sample.has_to_be_off =
      drive::command_of(objects.controlword.get()) == PowerCommand::disable_voltage &&
      axis.power_state() != PowerState::fault_reaction_active;
}

}  // namespace stator::tests
