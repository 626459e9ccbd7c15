#include "stator/devices/tmcm_142/axis_parameters.hpp"

#include <algorithm>
#include <limits>

#include "stator/control/motion_controller/motion_controller_units.hpp"

namespace stator::devices::tmcm_142 {

namespace {

using control::motion_controller::Mode;
using control::motion_controller::Settings;
using tmcl::ParameterDeclaration;
using tmcl::ParameterRange;
using tmcl::ParameterUnit;
using tmcl::Status;
using enum AxisParameter;
namespace units = control::motion_controller;

/// The largest velocities and accelerations in the units of AP 255 = 1 (L885-L886, A23); what is
/// beyond would not fit the chip's.
constexpr std::int32_t kLargestPulses = 31'999'999;
constexpr std::int32_t kLargestPulses2 = 976'562'441;

constexpr std::uint32_t kLargestFraction = 9'999;  // of parameter 42 in decimal mode (A35)
constexpr std::int32_t kReservedMode = 1;          // of parameter 128

std::int32_t to_user(ParameterUnit unit, std::int32_t raw) {
  switch (unit) {
    case ParameterUnit::velocity:
      return static_cast<std::int32_t>(
          std::clamp<std::int64_t>(units::pps_of_velocity(raw), -kLargestPulses, kLargestPulses));
    case ParameterUnit::acceleration:
      return static_cast<std::int32_t>(
          std::min<std::int64_t>(units::pps2_of_acceleration(raw), kLargestPulses2));
    default:
      return raw;
  }
}

std::int32_t to_raw(ParameterUnit unit, std::int32_t user) {
  switch (unit) {
    case ParameterUnit::velocity:
      return static_cast<std::int32_t>(units::velocity_of_pps(user));
    case ParameterUnit::acceleration:
      return static_cast<std::int32_t>(
          std::max<std::int64_t>(units::acceleration_of_pps2(user), 1));
    default:
      return user;
  }
}

}  // namespace

AxisParameters::AxisParameters(std::span<const ParameterDeclaration> declarations, MotionAxis& axis)
    : table_(declarations), values_(declarations), axis_(axis) {
  power_on();
}

void AxisParameters::power_on() {
  values_.power_on();
  configure();
  axis_.controller().set_encoder_mode(magnitude(encoder_mode));
  axis_.controller().set_microstep_resolution(
      static_cast<std::uint8_t>(value(microstep_resolution)));
}

std::size_t AxisParameters::place_of(AxisParameter parameter) const {
  return table_.index_of(*table_.find(static_cast<std::uint8_t>(parameter)));
}

std::int32_t AxisParameters::value(AxisParameter parameter) const {
  return values_.get(place_of(parameter));
}

std::uint32_t AxisParameters::magnitude(AxisParameter parameter) const {
  return static_cast<std::uint32_t>(value(parameter));
}

ParameterRange AxisParameters::range(const ParameterDeclaration& parameter) const {
  if (in_pulses_per_second()) {
    if (parameter.unit == ParameterUnit::velocity) {
      return {parameter.minimum < 0 ? -kLargestPulses : 0, kLargestPulses};
    }
    if (parameter.unit == ParameterUnit::acceleration) {
      return {1, kLargestPulses2};
    }
  }
  return parameter.range();
}

std::int32_t AxisParameters::read(AxisParameter parameter) {
  const std::int32_t raw = read_raw(parameter);
  return in_pulses_per_second()
             ? to_user(table_.find(static_cast<std::uint8_t>(parameter))->unit, raw)
             : raw;
}

Status AxisParameters::write(AxisParameter parameter, std::int32_t value) {
  return write_raw(parameter,
                   in_pulses_per_second()
                       ? to_raw(table_.find(static_cast<std::uint8_t>(parameter))->unit, value)
                       : value);
}

bool AxisParameters::rotate(std::int32_t velocity) {
  if (!in_pulses_per_second()) {
    axis_.rotate(velocity);
    return true;
  }
  if (velocity < -kLargestPulses || velocity > kLargestPulses) {
    return false;
  }
  axis_.rotate(to_raw(ParameterUnit::velocity, velocity));
  return true;
}

void AxisParameters::start_reference_search() {
  axis_.start_search({.mode = static_cast<control::motion_controller::SearchMode>(
                          value(AxisParameter::reference_search_mode)),
                      .search_speed = magnitude(reference_search_speed),
                      .switch_speed = magnitude(reference_switch_speed)});
}

std::int32_t AxisParameters::read_raw(AxisParameter parameter) {
  MotionAxis::Controller& controller = axis_.controller();
  switch (parameter) {
    case target_position:
      return controller.target_position();
    case actual_position:
      return controller.position();
    case target_speed:
      return controller.target_velocity();
    case actual_speed:
      return controller.velocity();
    case max_acceleration_and_deceleration:
      return value(max_acceleration);  // A22
    case position_reached:
      return controller.position_reached() ? 1 : 0;
    case switch_status:
      return static_cast<std::int32_t>(controller.read_switch_status());
    case right_limit_switch_status:
      return controller.right_switch() ? 1 : 0;
    case left_limit_switch_status:
      return controller.left_switch() ? 1 : 0;
    case actual_load_value:
      return axis_.stage().load_value();
    case driver_status:
      return (axis_.stage().error() ? 1 : 0) + (axis_.stage().over_temperature_warning() ? 2 : 0);
    case pid_i_sum:
      return controller.regulator_sum();
    case pid_error:
      return controller.regulator_error();
    case pid_vactual:
      return controller.pid_velocity();
    case encoder_position:
      return controller.encoder_position();
    case encoder_mode:
      return static_cast<std::int32_t>(controller.settings().encoder.mode);
    case encoder_status:
      return controller.read_encoder_status() ? 1 : 0;
    case encoder_latch:
      return controller.encoder_latch();
    case position_latch:
      return controller.latched_position();
    case microstep_table_position:
      return controller.table_position();
    case ramp_mode:
      return static_cast<std::int32_t>(controller.mode());
    case status_flags:
      return static_cast<std::int32_t>(controller.status_flags());
    case velocity_reached:
      return controller.velocity_reached() ? 1 : 0;
    case end_switch_distance:
      return axis_.search().switch_distance();
    case error_flags:
      return static_cast<std::int32_t>(controller.read_error_flags());
    default:
      return value(parameter);
  }
}

/// Writes of parameters that are commands and no settings.
Status AxisParameters::command(AxisParameter parameter, std::int32_t raw) {
  MotionAxis::Controller& controller = axis_.controller();
  switch (parameter) {
    case target_position:
      axis_.move_to(raw);
      break;
    case actual_position:
      controller.set_position(raw);
      break;
    case target_speed:
      axis_.set_target_velocity(raw);
      break;
    case pid_i_sum:
      controller.clear_regulator_sum();
      break;
    case encoder_position:
      controller.set_encoder_position(raw);
      break;
    case microstep_table_position:
      if (!controller.at_rest()) {
        return Status::invalid_value;  // A101
      }
      controller.set_table_position(raw);
      break;
    case ramp_mode:
      if (raw == kReservedMode) {
        return Status::invalid_value;  // A48
      }
      axis_.set_mode(static_cast<Mode>(raw));
      break;
    default:
      break;  // parameter 3: the ramp sets its velocity anew with its next step (A104)
  }
  return Status::success;
}

Status AxisParameters::write_raw(AxisParameter parameter, std::int32_t raw) {
  const ParameterDeclaration& declaration = *table_.find(static_cast<std::uint8_t>(parameter));
  if (!declaration.stored) {
    return command(parameter, raw);
  }
  if (parameter == encoder_constant &&
      (magnitude(encoder_mode) & control::motion_controller::encoder_mode::kDecimal) != 0 &&
      (static_cast<std::uint32_t>(raw) & 0xFFFFU) > kLargestFraction) {
    return Status::invalid_value;
  }
  values_.set(table_.index_of(declaration), raw);
  if (parameter == max_acceleration_and_deceleration) {
    values_.set(place_of(max_acceleration), raw);
    values_.set(place_of(max_deceleration), raw);
  }
  configure();
  if (parameter == encoder_mode) {
    axis_.controller().set_encoder_mode(static_cast<std::uint32_t>(raw));
  } else if (parameter == microstep_resolution) {
    axis_.controller().set_microstep_resolution(static_cast<std::uint8_t>(raw));
  } else if (parameter == compare_position) {
    axis_.arm_compare(raw);
  }
  return Status::success;
}

void AxisParameters::store(AxisParameter parameter) {
  if (parameter == max_acceleration_and_deceleration) {
    values_.store(place_of(max_acceleration));
    values_.store(place_of(max_deceleration));
  }
  const std::size_t place = place_of(parameter);
  values_.set(place, read_raw(parameter));
  values_.store(place);
}

void AxisParameters::restore(AxisParameter parameter) {
  if (parameter == max_acceleration_and_deceleration) {
    restore(max_acceleration);
    restore(max_deceleration);
    return;
  }
  const std::size_t place = place_of(parameter);
  values_.restore(place);
  static_cast<void>(write_raw(parameter, values_.get(place)));
}

void AxisParameters::configure() {
  axis_.controller().configure(settings());
  axis_.set_stage({.mixed_decay_run = value(mixed_decay_run) != 0,
                   .mixed_decay_standby = value(mixed_decay_standby) != 0,
                   .chopper_divider = value(chopper_clock_divider)});
}

Settings AxisParameters::settings() const {
  const auto flag = [this](AxisParameter parameter) { return value(parameter) != 0; };
  const auto byte = [this](AxisParameter parameter) {
    return static_cast<std::uint8_t>(value(parameter));
  };
  const auto word = [this](AxisParameter parameter) {
    return static_cast<std::uint16_t>(value(parameter));
  };
  Settings settings;
  settings.ramp = {.maximum_velocity = magnitude(max_positioning_speed),
                   .acceleration = magnitude(max_acceleration),
                   .deceleration = magnitude(max_deceleration),
                   .stop_deceleration = magnitude(stop_deceleration),
                   .bow = byte(bow)};
  settings.limits = {.right = value(right_position_limit),
                     .left = value(left_position_limit),
                     .right_enabled = flag(right_position_limit_enable),
                     .left_enabled = flag(left_position_limit_enable)};
  settings.switches = {.mode = magnitude(switch_mode),
                       .right_disabled = flag(right_limit_switch_disable),
                       .left_disabled = flag(left_limit_switch_disable)};
  settings.encoder = {.constant = magnitude(encoder_constant),
                      .mode = axis_.controller().settings().encoder.mode,
                      .warn_distance = magnitude(encoder_warn_distance),
                      .maximum_deviation = magnitude(maximum_encoder_deviation)};
  settings.regulator = {.tolerance = magnitude(pid_tolerance),
                        .p = magnitude(pid_p_factor),
                        .i = magnitude(pid_i_factor),
                        .d = magnitude(pid_d_factor),
                        .integral_clip = word(pid_i_clipping),
                        .d_divider = byte(pid_d_clock_divider),
                        .velocity_clip = magnitude(pid_dv_clipping),
                        .enabled = flag(pid_mode)};
  settings.current = {.run = byte(max_current),
                      .standby = byte(standby_current),
                      .standby_delay = word(standby_delay)};
  settings.shaft = flag(shaft);
  settings.sine_offset = byte(sine_wave_offset);
  settings.step_pulse_length = byte(step_pulse_length);
  return settings;
}

}  // namespace stator::devices::tmcm_142
