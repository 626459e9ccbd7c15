#include "stator/devices/tmc8461/sii.hpp"

#include <algorithm>

#include "stator/mfc/block/memory_map.hpp"

namespace stator::devices::tmc8461 {

namespace {

constexpr std::uint16_t kSpiSlave = 0x0005;
constexpr std::uint16_t kDeviceEmulation = 0x0100;
constexpr std::uint16_t kSyncAndLatchUnits = 0x0C00;
constexpr std::uint16_t kSyncOutputs = 0x6600;  ///< word 1: 0x0151 = 66h, its reset value

// Three buffers; the master's writes restart the process data watchdog.
constexpr std::uint8_t kOutputControl = 0x64;
constexpr std::uint8_t kInputControl = 0x20;

/// Codes of basic data types (ETG.1020) by size in bytes.
std::uint8_t data_type(const mfc::Register& entry) {
  switch (entry.size) {
    case 1:
      return 0x05;
    case 2:
      return 0x06;
    case 3:
      return 0x16;
    case 4:
      return 0x07;
    case 6:
      return 0x19;
    default:
      return 0x1B;
  }
}

ethercat::SiiPdo pdo_of(const mfc::MemoryMap& map, unsigned block, std::uint8_t sync_manager) {
  ethercat::SiiPdo pdo;
  pdo.index = block == 0 ? 0x1600 : 0x1A00;
  pdo.sync_manager = sync_manager;
  pdo.name = block == 0 ? "Written registers" : "Read registers";
  for (const mfc::MappedRegister& mapped : map.registers(block)) {
    const mfc::Register& entry = mfc::kRegisters[mapped.number];
    pdo.entries.push_back({.index = process_data_index(entry),
                           .subindex = 0,
                           .data_type = data_type(entry),
                           .bits = static_cast<std::uint8_t>(entry.width_bits()),
                           .name = std::string(entry.name)});
    if (const unsigned padding = (entry.mapped_size() - entry.size) * 8U; padding != 0) {
      pdo.entries.push_back({.bits = static_cast<std::uint8_t>(padding), .name = {}});
    }
  }
  return pdo;
}

}  // namespace

std::uint16_t process_data_index(const mfc::Register& entry) {
  const unsigned first = entry.direction == mfc::Direction::write ? 0x7000 : 0x6000;
  return static_cast<std::uint16_t>(first + entry.number);
}

ethercat::SiiContents sii_contents(const mfc::Configuration& configuration,
                                   const BoardIdentity& identity) {
  ethercat::SiiContents contents;
  contents.vendor_id = identity.vendor_id;
  contents.product_code = identity.product_code;
  contents.revision = identity.revision;
  contents.serial_number = identity.serial_number;
  contents.station_alias = identity.station_alias;
  contents.pdi_control =
      static_cast<std::uint16_t>(kSpiSlave | (identity.device_emulation ? kDeviceEmulation : 0) |
                                 (identity.distributed_clocks ? kSyncAndLatchUnits : 0));
  contents.pdi_configuration = kSyncOutputs;
  contents.sync_pulse_length = identity.sync_pulse_length;
  contents.size_kbit = identity.sii_size_kbit;
  contents.group = identity.group;
  contents.order_code = identity.order_code;
  contents.name = identity.name;
  contents.distributed_clocks = identity.distributed_clocks;

  const mfc::MemoryMap map(configuration);
  for (const unsigned block : {0U, 1U}) {
    const mfc::MemoryMap::Block& area = map.block(block);
    if (area.length == 0) {
      continue;
    }
    const auto sync_manager = static_cast<std::uint8_t>(contents.sync_managers.size());
    contents.fmmu_usage.push_back(block == 0 ? 1 : 2);
    contents.sync_managers.push_back({.start = static_cast<std::uint16_t>(area.start),
                                      .length = static_cast<std::uint16_t>(area.length),
                                      .control = block == 0 ? kOutputControl : kInputControl,
                                      .enable = 1,
                                      .type = static_cast<std::uint8_t>(block == 0 ? 3 : 4)});
    (block == 0 ? contents.rx_pdos : contents.tx_pdos).push_back(pdo_of(map, block, sync_manager));
  }
  const auto parameters = configuration.bytes().first(mfc::Configuration::kUsedLength);
  contents.parameter_ram.assign(parameters.begin(), parameters.end());
  return contents;
}

}  // namespace stator::devices::tmc8461
