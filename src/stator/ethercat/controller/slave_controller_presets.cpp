#include "stator/ethercat/controller/slave_controller_presets.hpp"

#include <array>

namespace stator::ethercat {

namespace {

using F = ControllerFeature;

/// Of the TMC8670's datasheet, what the family's feature table says is not built.
constexpr F kNotInTmc8670Silicon =
    F::read_write_offset | F::watchdog_setting | F::write_protection | F::buffer_event_times |
    F::error_counters | F::sii_host_access | F::lost_link_counters | F::mii_link_detection;

constexpr F kTmc8670Silicon = F::distributed_clocks | F::reset_registers | F::led_override |
                              F::pdi_information | F::mii_management | F::parameter_ram |
                              F::product_identity | F::user_ram;

constexpr SlaveControllerConfiguration tmc8461() {
  SlaveControllerConfiguration chip;
  chip.product_id = 0x0000000001108461;
  chip.vendor_id = 0x0000000100000286;
  return chip;
}

constexpr SlaveControllerConfiguration tmc8670_document() {
  SlaveControllerConfiguration chip;
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

constexpr SlaveControllerConfiguration tmc8670_silicon() {
  SlaveControllerConfiguration chip = tmc8670_document();
  chip.features = kTmc8670Silicon;
  chip.answered_features = kNotInTmc8670Silicon;
  return chip;
}

/// A coupler: ports, their counters and clocks; nothing for a host.
constexpr SlaveControllerConfiguration junction() {
  SlaveControllerConfiguration chip;
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
}

constexpr std::array<SlaveControllerPreset, 5> kPresets{{
    {"tmcm-3315", "standard", "the module's controller, with the registers of a TMC8461",
     RegisterDocument::tmc8461, SlaveControllerConfiguration{}},
    {"tmc8461", "standard", "EtherCAT slave controller with multi-function I/O",
     RegisterDocument::tmc8461, tmc8461()},
    {"tmc8670", "document", "every register the TMC8670's datasheet describes",
     RegisterDocument::tmc8670, tmc8670_document()},
    {"tmc8670", "silicon", "only the parts that the family's feature table says are built",
     RegisterDocument::tmc8670, tmc8670_silicon()},
    {"junction", "standard", "the controller of a coupler, here with four ports",
     RegisterDocument::tmc8461, junction()},
}};

}  // namespace

std::span<const SlaveControllerPreset> slave_controller_presets() {
  return kPresets;
}

const SlaveControllerPreset* find_slave_controller_preset(std::string_view device,
                                                          std::string_view name) {
  for (const SlaveControllerPreset& preset : kPresets) {
    if (preset.device == device && (name.empty() || preset.name == name)) {
      return &preset;
    }
  }
  return nullptr;
}

}  // namespace stator::ethercat
