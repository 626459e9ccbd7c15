#pragma once

#include <cstdint>
#include <string>

#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/mfc/registers/register_map.hpp"

namespace stator::devices::tmc8461 {

/// What a board with the chip tells of itself.
struct BoardIdentity {
  std::uint32_t vendor_id = 0x0286;
  std::string vendor_name = "Trinamic";
  std::uint32_t product_code = 0x8461;
  std::uint32_t revision = 1;
  std::uint32_t serial_number = 0;
  std::string name = "TMC8461";
  std::string order_code = "TMC8461";
  std::string group = "Input and output";
  std::uint16_t station_alias = 0;
  bool device_emulation = true;  ///< no controller: the chip follows the master itself
  bool distributed_clocks = true;
  std::uint16_t sync_pulse_length = 100;  ///< 10 ns
  std::uint16_t sii_size_kbit = 16;
};

/// Index of the object that stands for a mapped register in process data: 7000h + register number
/// for what the master writes, 6000h + register number for what it reads.
[[nodiscard]] std::uint16_t process_data_index(const mfc::Register& entry);

/// The contents of the EEPROM of a board whose process data are the registers that `configuration`
/// maps: sync manager 0 for the block the master writes, 1 for the one it reads, one PDO for each,
/// padding as entries without object, and the configuration as category 1.
[[nodiscard]] ethercat::SiiContents sii_contents(const mfc::Configuration& configuration,
                                                 const BoardIdentity& identity);

}  // namespace stator::devices::tmc8461
