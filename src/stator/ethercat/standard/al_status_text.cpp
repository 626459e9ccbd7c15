#include "stator/ethercat/standard/al_status_text.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace stator::ethercat {

namespace {

constexpr auto kStatusCodeTexts = std::to_array<std::pair<AlStatusCode, std::string_view>>({
    {AlStatusCode::no_error, "no error"},
    {AlStatusCode::unspecified_error, "unspecified error"},
    {AlStatusCode::no_memory, "no memory"},
    {AlStatusCode::invalid_device_setup, "invalid device setup"},
    {AlStatusCode::invalid_requested_state_change, "invalid requested state change"},
    {AlStatusCode::unknown_requested_state, "unknown requested state"},
    {AlStatusCode::bootstrap_not_supported, "bootstrap not supported"},
    {AlStatusCode::no_valid_firmware, "no valid firmware"},
    {AlStatusCode::invalid_mailbox_configuration_bootstrap,
     "invalid mailbox configuration for Bootstrap"},
    {AlStatusCode::invalid_mailbox_configuration_pre_operational,
     "invalid mailbox configuration for Pre-Operational"},
    {AlStatusCode::invalid_sync_manager_configuration, "invalid sync manager configuration"},
    {AlStatusCode::no_valid_inputs_available, "no valid inputs available"},
    {AlStatusCode::no_valid_outputs, "no valid outputs"},
    {AlStatusCode::synchronization_error, "synchronization error"},
    {AlStatusCode::sync_manager_watchdog, "sync manager watchdog"},
    {AlStatusCode::invalid_sync_manager_types, "invalid sync manager types"},
    {AlStatusCode::invalid_output_configuration, "invalid output configuration"},
    {AlStatusCode::invalid_input_configuration, "invalid input configuration"},
    {AlStatusCode::invalid_watchdog_configuration, "invalid watchdog configuration"},
    {AlStatusCode::slave_needs_cold_start, "slave needs cold start"},
    {AlStatusCode::slave_needs_init, "slave needs Init"},
    {AlStatusCode::slave_needs_pre_operational, "slave needs Pre-Operational"},
    {AlStatusCode::slave_needs_safe_operational, "slave needs Safe-Operational"},
    {AlStatusCode::invalid_input_mapping, "invalid input mapping"},
    {AlStatusCode::invalid_output_mapping, "invalid output mapping"},
    {AlStatusCode::inconsistent_settings, "inconsistent settings"},
    {AlStatusCode::free_run_not_supported, "free run not supported"},
    {AlStatusCode::synchronization_not_supported, "synchronization not supported"},
    {AlStatusCode::free_run_needs_three_buffer_mode, "free run needs three-buffer mode"},
    {AlStatusCode::background_watchdog, "background watchdog"},
    {AlStatusCode::no_valid_inputs_and_outputs, "no valid inputs and outputs"},
    {AlStatusCode::fatal_sync_error, "fatal synchronization error"},
    {AlStatusCode::no_sync_error, "no synchronization signal"},
    {AlStatusCode::invalid_dc_sync_configuration, "invalid DC sync configuration"},
    {AlStatusCode::invalid_dc_latch_configuration, "invalid DC latch configuration"},
    {AlStatusCode::pll_error, "PLL error"},
    {AlStatusCode::dc_sync_io_error, "DC sync I/O error"},
    {AlStatusCode::dc_sync_timeout, "DC sync timeout"},
    {AlStatusCode::dc_invalid_sync_cycle_time, "DC invalid sync cycle time"},
    {AlStatusCode::dc_sync0_cycle_time, "DC SYNC0 cycle time"},
    {AlStatusCode::dc_sync1_cycle_time, "DC SYNC1 cycle time"},
    {AlStatusCode::mailbox_eoe, "EoE mailbox error"},
    {AlStatusCode::mailbox_coe, "CoE mailbox error"},
    {AlStatusCode::mailbox_foe, "FoE mailbox error"},
    {AlStatusCode::mailbox_soe, "SoE mailbox error"},
    {AlStatusCode::mailbox_voe, "VoE mailbox error"},
    {AlStatusCode::eeprom_no_access, "EEPROM cannot be accessed"},
    {AlStatusCode::eeprom_error, "EEPROM error"},
    {AlStatusCode::slave_restarted_locally, "slave restarted locally"},
    {AlStatusCode::device_identification_updated, "device identification value updated"},
});

}  // namespace

std::string_view to_text(AlStatusCode code) {
  const auto* const row =
      std::find_if(kStatusCodeTexts.begin(), kStatusCodeTexts.end(),
                   [code](const auto& candidate) { return candidate.first == code; });
  return row == kStatusCodeTexts.end() ? "unknown AL status code" : row->second;
}

}  // namespace stator::ethercat
