#pragma once

#include <cstdint>
#include <span>

#include "stator/tmcl/module/module_description.hpp"

namespace stator::devices::tmcm_142 {

/// Numbers of the axis parameters, as programs write them.
enum class AxisParameter : std::uint8_t {
  target_position = 0,
  actual_position = 1,
  target_speed = 2,
  actual_speed = 3,
  max_positioning_speed = 4,
  max_acceleration_and_deceleration = 5,
  max_current = 6,
  standby_current = 7,
  position_reached = 8,
  switch_status = 9,
  right_limit_switch_status = 10,
  left_limit_switch_status = 11,
  right_limit_switch_disable = 12,
  left_limit_switch_disable = 13,
  switch_mode = 14,
  stop_deceleration = 15,
  max_acceleration = 16,
  max_deceleration = 17,
  bow = 18,
  shaft = 19,
  standby_delay = 20,
  mixed_decay_run = 21,
  mixed_decay_standby = 22,
  chopper_clock_divider = 23,
  actual_load_value = 25,
  driver_status = 26,
  microstep_resolution = 27,
  pid_tolerance = 28,
  sine_wave_offset = 29,
  pid_p_factor = 30,
  pid_i_factor = 31,
  pid_d_factor = 32,
  pid_i_clipping = 33,
  pid_i_sum = 34,
  pid_d_clock_divider = 35,
  pid_dv_clipping = 37,
  pid_error = 38,
  pid_vactual = 39,
  pid_mode = 40,
  encoder_position = 41,
  encoder_constant = 42,
  encoder_mode = 43,
  encoder_status = 44,
  encoder_latch = 45,
  position_latch = 46,
  encoder_warn_distance = 47,
  compare_position = 48,
  right_position_limit = 50,
  left_position_limit = 51,
  right_position_limit_enable = 52,
  left_position_limit_enable = 53,
  microstep_table_position = 63,
  step_pulse_length = 64,
  ramp_mode = 128,
  status_flags = 129,
  velocity_reached = 130,
  reference_search_mode = 193,
  reference_search_speed = 194,
  reference_switch_speed = 195,
  end_switch_distance = 196,
  error_flags = 207,
  maximum_encoder_deviation = 212,
  unit_conversion_mode = 255,
};

/// Global parameters of bank 0 that the module itself obeys; others are tmcl::GlobalParameter.
enum class ModuleParameter : std::uint8_t {
  eeprom_magic = 64,
  baud_rate = 65,
  can_bit_rate = 69,
  shutdown_pin_functionality = 80,
};

/// Axis parameters in the order of their numbers (TMCM-142 TMCL Firmware Manual, chapter 7,
/// L5219-L5862), read with decisions A24, A27, A33, A34, A39, A48, A50, A52, A55, A56 and A103.
///
/// What a row cannot say and the module has to do: 5 writes 16 and 17 (A22), any value written to
/// 34 clears it (A33), 42 in decimal mode refuses low halves above 9999 (A35), 128 refuses 1 (A48).
[[nodiscard]] std::span<const tmcl::ParameterDeclaration> axis_parameters();

/// Global parameters of bank 0 and the variables of bank 2, in this order (chapter 8,
/// L5921-L6058), read with decisions A9, A11, A60 and A105.
///
/// What a row cannot say: 73 takes 1234 and 4321 and reads 1 and 0; its range holds both. Rows of
/// bank 0 that are stored live in the EEPROM only, those of bank 2 by STGP.
[[nodiscard]] std::span<const tmcl::ParameterDeclaration> global_parameters();

}  // namespace stator::devices::tmcm_142

namespace stator::devices {

/// The module for assembler, disassembler and lists. Lives as long as the program.
[[nodiscard]] const tmcl::ModuleDescription& tmcm_142_description();

}  // namespace stator::devices
