#pragma once

#include <cstdint>

#include "stator/base/event_text.hpp"

namespace stator::ethercat {

/// States of the EtherCAT state machine as they stand in AL control and AL status
/// (ETG.1000.6 §6.4.1, registers 0x0120 and 0x0130).
enum class AlState : std::uint8_t {
  init = 1,
  pre_operational = 2,
  bootstrap = 3,
  safe_operational = 4,
  operational = 8,
};

/// The standard's name, e.g. "Safe-Operational"; "?" for a number that is no state.
[[nodiscard]] constexpr base::StaticText to_text(AlState state) {
  switch (state) {
    case AlState::init:
      return "Init";
    case AlState::pre_operational:
      return "Pre-Operational";
    case AlState::bootstrap:
      return "Bootstrap";
    case AlState::safe_operational:
      return "Safe-Operational";
    case AlState::operational:
      return "Operational";
  }
  return "?";
}

/// AL status codes (ETG.1020 table 15, register 0x0134).
enum class AlStatusCode : std::uint16_t {
  no_error = 0x0000,
  unspecified_error = 0x0001,
  no_memory = 0x0002,
  invalid_device_setup = 0x0003,
  invalid_requested_state_change = 0x0011,
  unknown_requested_state = 0x0012,
  bootstrap_not_supported = 0x0013,
  no_valid_firmware = 0x0014,
  invalid_mailbox_configuration_bootstrap = 0x0015,
  invalid_mailbox_configuration_pre_operational = 0x0016,
  invalid_sync_manager_configuration = 0x0017,
  no_valid_inputs_available = 0x0018,
  no_valid_outputs = 0x0019,
  synchronization_error = 0x001A,
  sync_manager_watchdog = 0x001B,
  invalid_sync_manager_types = 0x001C,
  invalid_output_configuration = 0x001D,
  invalid_input_configuration = 0x001E,
  invalid_watchdog_configuration = 0x001F,
  slave_needs_cold_start = 0x0020,
  slave_needs_init = 0x0021,
  slave_needs_pre_operational = 0x0022,
  slave_needs_safe_operational = 0x0023,
  invalid_input_mapping = 0x0024,
  invalid_output_mapping = 0x0025,
  inconsistent_settings = 0x0026,
  free_run_not_supported = 0x0027,
  synchronization_not_supported = 0x0028,
  free_run_needs_three_buffer_mode = 0x0029,
  background_watchdog = 0x002A,
  no_valid_inputs_and_outputs = 0x002B,
  fatal_sync_error = 0x002C,
  no_sync_error = 0x002D,
  invalid_dc_sync_configuration = 0x0030,
  invalid_dc_latch_configuration = 0x0031,
  pll_error = 0x0032,
  dc_sync_io_error = 0x0033,
  dc_sync_timeout = 0x0034,
  dc_invalid_sync_cycle_time = 0x0035,
  dc_sync0_cycle_time = 0x0036,
  dc_sync1_cycle_time = 0x0037,
  mailbox_eoe = 0x0042,
  mailbox_coe = 0x0043,
  mailbox_foe = 0x0044,
  mailbox_soe = 0x0045,
  mailbox_voe = 0x004F,
  eeprom_no_access = 0x0050,
  eeprom_error = 0x0051,
  slave_restarted_locally = 0x0060,
  device_identification_updated = 0x0061,
};

}  // namespace stator::ethercat
