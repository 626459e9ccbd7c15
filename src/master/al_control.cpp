#include "master/al_control.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "master/registers.hpp"
#include "master/text.hpp"

namespace stator::master {

using ethercat::AlState;
using ethercat::AlStatusCode;

namespace {

constexpr std::uint16_t kErrorAcknowledge = 0x10;  // AL control bit 4; AL status bit 4: error
constexpr std::uint16_t kStateMask = 0x0F;

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

/// Writes AL control until the slave takes it: the register is locked while the slave has not yet
/// looked at an earlier request.
Result<void> write_al_control(Bus& bus, const Station& station, std::uint16_t value,
                              base::SimTime deadline, const Idle& idle) {
  while (true) {
    auto written = bus.write_number<std::uint16_t>(station, registers::kAlControl, value);
    if (written || written.error().code != ErrorCode::working_counter ||
        bus.port().now() >= deadline) {
      return written;
    }
    if (auto waited = idle(); !waited) {
      return waited;
    }
  }
}

Error refusal(const Station& station, AlState wanted, const AlStatus& status) {
  const auto code = static_cast<std::uint16_t>(status.code);
  return {ErrorCode::state_refused, code,
          station.name() + " refused " + std::string(ethercat::to_text(wanted)) +
              ": AL status code " + hexadecimal(code, 4) + " " + std::string(to_text(status.code)) +
              "; it is in " + std::string(ethercat::to_text(status.state))};
}

/// Whether the slave controller itself copies AL control to AL status, as without a host. What
/// looks like an error is then the acknowledgement that was written, and goes with the next
/// request.
Result<bool> follows_by_itself(Bus& bus, const Station& station) {
  const auto configuration = bus.read_number<std::uint8_t>(station, registers::kEscConfiguration);
  if (!configuration) {
    return base::Unexpected{configuration.error()};
  }
  return (*configuration & 1U) != 0;
}

Result<void> acknowledge_error(Bus& bus, const Station& station, base::SimTime deadline,
                               const Idle& idle) {
  while (true) {
    const auto status = read_al_status(bus, station);
    if (!status) {
      return base::Unexpected{status.error()};
    }
    if (!status->error) {
      return {};
    }
    if (status->code == AlStatusCode::no_error) {
      const auto echo = follows_by_itself(bus, station);
      if (!echo || *echo) {
        return echo ? Result<void>() : Result<void>(base::Unexpected{echo.error()});
      }
    }
    if (bus.port().now() >= deadline) {
      return fail(ErrorCode::state_timeout,
                  station.name() + " keeps indicating AL status code " +
                      hexadecimal(static_cast<std::uint16_t>(status->code), 4) + " " +
                      std::string(to_text(status->code)) + " although it was acknowledged");
    }
    const auto control =
        static_cast<std::uint16_t>(static_cast<std::uint16_t>(status->state) | kErrorAcknowledge);
    if (auto written = write_al_control(bus, station, control, deadline, idle); !written) {
      return written;
    }
    if (auto waited = idle(); !waited) {
      return waited;
    }
  }
}

}  // namespace

std::string_view to_text(AlStatusCode code) {
  const auto* const row =
      std::find_if(kStatusCodeTexts.begin(), kStatusCodeTexts.end(),
                   [code](const auto& candidate) { return candidate.first == code; });
  return row == kStatusCodeTexts.end() ? "unknown AL status code" : row->second;
}

Result<AlStatus> read_al_status(Bus& bus, const Station& station) {
  std::array<std::byte, 6> data{};
  if (const auto done = bus.read(station, registers::kAlStatus, data); !done) {
    return base::Unexpected{done.error()};
  }
  const auto status = base::load_le<std::uint16_t>(data.data());
  return AlStatus{.state = static_cast<AlState>(status & kStateMask),
                  .error = (status & kErrorAcknowledge) != 0,
                  .code = static_cast<AlStatusCode>(base::load_le<std::uint16_t>(data.data() + 4))};
}

Result<void> request_al_state(Bus& bus, const Station& station, AlState state, const Idle& idle) {
  const base::SimTime deadline = bus.port().now() + bus.options().state_timeout;
  if (auto acknowledged = acknowledge_error(bus, station, deadline, idle); !acknowledged) {
    return acknowledged;
  }
  if (auto written =
          write_al_control(bus, station, static_cast<std::uint16_t>(state), deadline, idle);
      !written) {
    return written;
  }
  while (true) {
    const auto status = read_al_status(bus, station);
    if (!status) {
      return base::Unexpected{status.error()};
    }
    if (status->error) {
      return base::Unexpected{refusal(station, state, *status)};
    }
    if (status->state == state) {
      return {};
    }
    if (bus.port().now() >= deadline) {
      return fail(ErrorCode::state_timeout,
                  station.name() + " neither reached nor refused " +
                      std::string(ethercat::to_text(state)) + " within " +
                      std::to_string(bus.options().state_timeout.nanoseconds() / 1'000'000) +
                      " ms; it is in " + std::string(ethercat::to_text(status->state)));
    }
    if (auto waited = idle(); !waited) {
      return waited;
    }
  }
}

}  // namespace stator::master
