// The EtherCAT slave controller of a TMC8670 as its datasheet prints it, and as the chip is built.
#pragma once

#include <array>

#include "stator/ethercat/controller/controller_preset.hpp"

namespace stator::devices::tmc8670 {

constexpr ethercat::SlaveControllerConfiguration documented_controller() {
  ethercat::SlaveControllerConfiguration chip;
  chip.type = 0xD0;
  chip.revision = 0x70;
  chip.build = 0x0010;
  chip.fmmu_count = 4;
  chip.sync_manager_count = 4;
  chip.ram_kilobytes = 4;
  chip.port_descriptor = 0x0F;
  chip.product_id = 0x0000000001008670;
  chip.vendor_id = 0x0000000100000286;
  chip.sync_latch_reset = 0;
  chip.sii_error_blocks_commands = true;
  return chip;
}

/// Of the datasheet, what the family's feature table says is not built, answers with 0.
constexpr ethercat::SlaveControllerConfiguration built_controller() {
  using F = ethercat::ControllerFeature;
  ethercat::SlaveControllerConfiguration chip = documented_controller();
  chip.features = F::distributed_clocks | F::reset_registers | F::led_override |
                  F::pdi_information | F::mii_management | F::parameter_ram | F::product_identity |
                  F::user_ram;
  chip.answered_features = F::read_write_offset | F::watchdog_setting | F::write_protection |
                           F::buffer_event_times | F::error_counters | F::sii_host_access |
                           F::lost_link_counters | F::mii_link_detection;
  return chip;
}

/// Two readings of the chip's slave controller. `document` has every register its datasheet
/// describes, as a master written by that datasheet expects. `silicon` lacks the parts that the
/// feature table of the family (TMC8461 datasheet L1945-L2085, column TMC8670) marks as not built:
/// their registers read 0 and ignore writes, and the working counter counts.
inline constexpr std::array kControllers{
    ethercat::ControllerPreset{"document", "every register the TMC8670's datasheet describes",
                               ethercat::RegisterDocument::drive, documented_controller()},
    ethercat::ControllerPreset{"silicon",
                               "only the parts that the family's feature table says are built",
                               ethercat::RegisterDocument::drive, built_controller()},
};

}  // namespace stator::devices::tmc8670
