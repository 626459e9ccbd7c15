#pragma once

#include <cstdint>

#include "stator/base/event_text.hpp"

namespace stator::tmcl {

/// Command numbers of TMCL, as Trinamic's modules and its PyTrinamic client number them.
enum class Command : std::uint8_t {
  rotate_right = 1,
  rotate_left = 2,
  motor_stop = 3,
  move_to_position = 4,
  set_axis_parameter = 5,
  get_axis_parameter = 6,
  store_axis_parameter = 7,
  restore_axis_parameter = 8,
  set_global_parameter = 9,
  get_global_parameter = 10,
  store_global_parameter = 11,
  restore_global_parameter = 12,
  reference_search = 13,
  set_output = 14,
  get_input = 15,
  calculate = 19,
  compare = 20,
  jump_conditionally = 21,
  jump_always = 22,
  call_subroutine = 23,
  return_from_subroutine = 24,
  wait = 27,
  stop = 28,
  set_coordinate = 30,
  get_coordinate = 31,
  capture_coordinate = 32,
  calculate_with_x = 33,
  accumulator_to_axis_parameter = 34,
  accumulator_to_global_parameter = 35,
  clear_error_flags = 36,
  accumulator_to_coordinate = 39,
  user_function_0 = 64,
  user_function_1 = 65,
  user_function_2 = 66,
  user_function_3 = 67,
  user_function_4 = 68,
  user_function_5 = 69,
  user_function_6 = 70,
  user_function_7 = 71,
  stop_application = 128,
  run_application = 129,
  step_application = 130,
  reset_application = 131,
  start_download = 132,
  quit_download = 133,
  read_memory = 134,
  get_application_status = 135,
  get_firmware_version = 136,
  restore_factory_settings = 137,
  request_target_reached_event = 138,
  enter_ascii_mode = 139,
  boot_erase_all = 200,
  boot_write_buffer = 201,
  boot_write_page = 202,
  boot_get_checksum = 203,
  boot_read_memory = 204,
  boot_start_application = 205,
  boot_get_info = 206,
  boot_write_length = 208,
  boot = 242,
  software_reset = 255,
};

/// Hosts send these two and wait for no reply, since a module restarts with them (PyTrinamic's
/// send_boot and send_start_app). Any reply, a refusal too, would be taken for that of the host's
/// next command, and every later one would come one late.
[[nodiscard]] constexpr bool is_never_answered(std::uint8_t command) {
  return static_cast<Command>(command) == Command::boot ||
         static_cast<Command>(command) == Command::boot_start_application;
}

/// Mnemonic or short name, e.g. "MVP" of 4; empty if no command has that number. Of static
/// lifetime.
[[nodiscard]] base::StaticText name_of(std::uint8_t command);

}  // namespace stator::tmcl
