#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/board/assembly/board_configuration.hpp"

namespace stator::devices {

/// What surrounds a TMC8461 on its board: EEPROM and configuration pins.
struct Tmc8461Configuration {
  /// The EEPROM's content. Empty: it is made from what follows.
  std::vector<std::byte> sii{};

  std::uint32_t vendor_id = 0x0286;
  std::uint32_t product_code = 0x8461;
  std::uint32_t revision = 1;
  std::uint32_t serial_number = 0;
  std::uint16_t station_alias = 0;
  std::string name = "TMC8461";

  /// Process data of a fixed size in sync managers 2 and 3, bytes, 0..128 each.
  std::uint16_t output_bytes = 4;
  std::uint16_t input_bytes = 4;
  /// Where they begin, 0x1000..0x4FFF.
  std::uint16_t output_address = 0x1100;
  std::uint16_t input_address = 0x1400;
  /// Length of each mailbox (sync managers 0 and 1, from 0x1000 on); 0: the firmware has none.
  std::uint16_t mailbox_bytes = 0;
  bool coe = false;  ///< the firmware has an object dictionary behind its mailbox

  std::uint8_t pdi_configuration = 0x03;  ///< 0x0150: SPI mode 3, interrupt and chip select low
  /// 0x0151: both SYNC pins are outputs, push-pull, active high.
  std::uint8_t sync_latch_configuration = 0x44;
  std::uint16_t sync_pulse_length = 1000;  ///< 0x0982, 10 ns; 0: the host ends a pulse

  // Configuration pins.
  bool device_emulation = false;  ///< PDI_EMULATION: the AL state follows the master's request
  bool shared_bus = false;        ///< PDI_SHARED_BUS: both SPI slaves on the pins of one
  bool phy_offset = false;        ///< PHY_OFFSET
  bool large_eeprom = false;      ///< PROM_SIZE: 32 kbit instead of 16 kbit
  bool link_polarity = false;     ///< LINK_POLARITY: the link pins of both ports are active high
  std::array<bool, 2> phy_link_active_high{};  ///< what the PHYs drive there
  /// MII_TX_SHIFT, 0..3 steps of 10 ns for both ports; nothing: MII_TX_CLKx are connected and the
  /// chip finds the steps itself (L1268).
  std::optional<std::uint8_t> tx_shift = std::uint8_t{0};
  /// ns by which the PHYs' transmit clocks are late against the chip's, 0..30.
  std::array<std::uint8_t, 2> tx_clock_phase{};
  /// At which the PHYs of ports 0 and 1 answer; nothing: where the chip looks for them.
  std::optional<std::array<std::uint8_t, 2>> phy_addresses{};
  /// RESET_OUT leads back to NRESET through an inverter, as the document asks for. Without it a
  /// reset by register is only shown (L522).
  bool reset_loop = true;
  bool emergency_released = true;  ///< MFC_NES is driven high; open it reads low (L644)

  board::BoardConfiguration board{};  ///< what is wired to the pins of the I/O block

  bool acknowledge_by_write = false;  ///< the host acknowledges events by writing (0x014E bit 0)
};

}  // namespace stator::devices
