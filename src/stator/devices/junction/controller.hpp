#pragma once

#include "stator/ethercat/controller/controller_preset.hpp"

namespace stator::devices {

/// The slave controller of a coupler: ports, their counters and clocks; nothing for a host.
inline constexpr ethercat::ControllerPreset kJunctionController{
    "standard", "the controller of a coupler, here with four ports",
    ethercat::RegisterDocument::controller, [] {
      using F = ethercat::ControllerFeature;
      ethercat::SlaveControllerConfiguration chip;
      chip.type = 0x4A;  // nobody's
      chip.revision = 0x01;
      chip.build = 0x0001;
      chip.fmmu_count = 4;  // unused, but masters switch those off that they do not need
      chip.sync_manager_count = 4;
      chip.ram_kilobytes = 1;
      chip.port_descriptor = 0xFF;
      chip.features = F::distributed_clocks | F::reset_registers | F::led_override |
                      F::pdi_information | F::user_ram | F::error_counters | F::lost_link_counters |
                      F::sii_host_access | F::watchdog_setting;
      chip.sync_latch_reset = 0;
      return chip;
    }()};

}  // namespace stator::devices
