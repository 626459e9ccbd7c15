#pragma once

#include <cstdint>
#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/units/mii_management.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat {

/// What distinguishes one slave controller product from another. The defaults are those of the
/// TMC8461 (datasheet, sections "Chip features" and "ESC information registers").
struct SlaveControllerConfiguration {
  std::uint8_t type = 0xD0;
  std::uint8_t revision = 0x61;
  std::uint16_t build = 0x0011;
  std::uint8_t fmmu_count = 8;          ///< 0..16
  std::uint8_t sync_manager_count = 8;  ///< 0..16
  std::uint8_t ram_kilobytes = 16;      ///< process memory from 0x1000 on, 1..60
  std::uint8_t port_descriptor = 0x0F;  ///< 2 bits per port: 0 none, 2 E-bus, 3 MII
  std::uint64_t product_id = 0;         ///< 0x0E00, with the feature product_identity
  std::uint64_t vendor_id = 0;          ///< 0x0E08

  ControllerFeature features =
      ControllerFeature::distributed_clocks | ControllerFeature::write_protection |
      ControllerFeature::reset_registers | ControllerFeature::read_write_offset |
      ControllerFeature::led_override | ControllerFeature::pdi_information |
      ControllerFeature::mii_management | ControllerFeature::parameter_ram |
      ControllerFeature::buffer_event_times | ControllerFeature::product_identity |
      ControllerFeature::user_ram | ControllerFeature::error_counters |
      ControllerFeature::lost_link_counters | ControllerFeature::mii_link_detection |
      ControllerFeature::sii_host_access | ControllerFeature::watchdog_setting;
  /// Parts that are not built although the document describes their registers: these read 0 and
  /// ignore writes, but the working counter counts. All other bytes without a register leave it.
  ControllerFeature answered_features = ControllerFeature::always;
  std::uint8_t sync_latch_reset = 0x66;  ///< 0x0151 until the EEPROM is loaded

  /// Sync managers of one byte have buffers like any other, as in the controllers that digital
  /// terminals are built with. False: one that triggers the watchdog does nothing else, others are
  /// too short (datasheet of the TMC8461).
  bool one_byte_sync_managers = false;
  std::uint8_t host_interface = 0x05;  ///< the type that is built (SII word 0): an SPI slave
  bool device_emulation = false;       ///< pin PDI_EMULATION: AL status follows AL control
  /// A completed reset sequence (0x0040, 0x0041) only raises RESET_OUT; the board leads it back to
  /// NRESET, which is power_on_reset(). False: that loop is closed inside.
  bool reset_by_board = false;
  bool acknowledge_by_write = false;  ///< host acknowledges events by writing (0x014E bit 0)
  /// "System time PDI controlled": the host instead of the bus writes 0x0910..0x0935, and what it
  /// writes to 0x0910 is the time at which a reference clock gave the edge at latch input 0.
  bool host_controls_time = false;
  bool link_active_high = false;  ///< strap LINK_POLARITY, of the link pins of all ports

  /// From receiving at one port to sending at the next open one, with the default receive FIFO.
  base::SimDuration forwarding_delay = base::SimDuration(300);
  std::int32_t clock_deviation_ppb = 0;  ///< of the oscillator
  SiiTiming sii_timing;
  /// 0x0502: after an error, commands other than 0 are ignored until command 0 clears it.
  bool sii_error_blocks_commands = false;
  MiiSettings mii;
};

/// Writes the constants and reset values that differ between builds: identification, features,
/// what MII management can do, IDs. The other reset values are declared with the registers.
void write_build_registers(const SlaveControllerConfiguration& configuration,
                           std::span<std::byte, kRegisterSpace> registers);

}  // namespace stator::ethercat
