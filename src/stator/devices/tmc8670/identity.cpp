#include "stator/devices/tmc8670/identity.hpp"

#include <stdexcept>

#include "stator/devices/tmc8670/axis_unit.hpp"
#include "stator/devices/tmc8670/internal/controllers.hpp"
#include "stator/product/shell/coe_stack.hpp"

namespace stator::devices::tmc8670 {

namespace {

using base::SimDuration;

// 4 KB of process memory (L1248): mailboxes of 512 bytes, the rest in halves for outputs and
// inputs, three buffers each.
constexpr std::uint16_t kProcessMemoryEnd = 0x2000;
constexpr ethercat::MailboxArea kReceiveMailbox{0x1000, 512};
constexpr ethercat::MailboxArea kTransmitMailbox{0x1200, 512};
constexpr std::uint16_t kOutputs = 0x1400;
constexpr std::uint16_t kInputs = 0x1A00;
/// PROM_SIZE reads 1 when it is open (L322): an EEPROM of 32 kbit or more.
constexpr std::uint16_t kEepromKilobits = 32;

constexpr std::uint16_t kPdiControl = 0x0C05;   // SPI inside the chip (L1067); SYNC and latch units
constexpr std::uint8_t kSyncOutputs = 0x66;     // push-pull, active high, no AL events
constexpr std::uint16_t kSyncPulse = 1000;      // 10 us
constexpr SimDuration kShortestCycle{250'000};  // 1C32h:05
constexpr SimDuration kLongestCycle{1'000'000'000};

}  // namespace

ethercat::DeviceDescription describe(const Tmc8670Configuration& configuration) {
  ethercat::DeviceDescription description;
  description.vendor_id = 0x00000286;
  description.vendor_name = "TRINAMIC Motion Control GmbH & Co. KG";
  description.product_code = 0x01008670;
  description.revision = 0x00010000;
  description.serial_number = configuration.serial_number;
  description.order_code = "TMC8670";
  description.name = "TMC8670";
  description.group = "Drives";
  description.station_alias = configuration.coe.station_alias;
  description.receive_mailbox = kReceiveMailbox;
  description.transmit_mailbox = kTransmitMailbox;
  description.output_offset = kOutputs;
  description.input_offset = kInputs;
  description.bootstrap_receive_mailbox = kReceiveMailbox;
  description.bootstrap_transmit_mailbox = kTransmitMailbox;
  description.coe = true;
  description.foe = true;
  description.eoe = configuration.coe.ethernet_over_ethercat;
  description.sdo_information = true;
  description.complete_access = true;
  description.pdo_assign = true;
  description.pdo_configuration = true;
  description.distributed_clocks = true;
  description.pdi_control = kPdiControl;
  description.sync_latch_configuration = kSyncOutputs;
  description.sync_pulse_length = kSyncPulse;
  description.sii_size_kbit = kEepromKilobits;
  return description;
}

ethercat::SlaveStackOptions stack_options(const Tmc8670Configuration& configuration) {
  ethercat::SlaveStackOptions options =
      product::coe_stack_options(configuration.coe, configuration.quirks);
  options.foe.bootstrap_only = true;
  options.process_memory_end = kProcessMemoryEnd;
  options.distributed_clocks.sync0 = true;
  options.distributed_clocks.shortest_cycle = kShortestCycle;
  options.distributed_clocks.longest_cycle = kLongestCycle;
  options.distributed_clocks.cycle_step = AxisUnit::kControlPeriod;
  return options;
}

ethercat::SlaveControllerConfiguration controller_of(const Tmc8670Configuration& configuration) {
  const ethercat::ControllerPreset* preset =
      ethercat::find_preset(kControllers, configuration.controller);
  if (preset == nullptr) {
    throw std::logic_error("a TMC8670 has no slave controller preset " + configuration.controller);
  }
  ethercat::SlaveControllerConfiguration controller = preset->configuration;
  controller.clock_deviation_ppb = configuration.clock_deviation_ppb;
  controller.link_active_high = configuration.link_polarity;
  controller.host_controls_time = configuration.host_controls_time;
  controller.mii.phy_link_active_high = configuration.phy_link_active_high;
  controller.mii.automatic_transmit_shift = !configuration.tx_shift.has_value();
  controller.mii.transmit_shift = configuration.tx_shift.value_or(controller.mii.transmit_shift);
  controller.mii.transmit_clock_phase = configuration.tx_clock_phase;
  controller.mii.phy_addresses = configuration.phy_addresses.value_or(controller.mii.phy_addresses);
  return controller;
}

}  // namespace stator::devices::tmc8670
