#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "stator/dictionary/quirks.hpp"

namespace stator::ethercat {

/// Start address and length of one mailbox in the controller's process memory.
struct MailboxArea {
  std::uint16_t offset = 0;
  std::uint16_t length = 0;
};

/// What a product tells about itself beyond its dictionary: the source of its SII image (ETG.2010)
/// and its ESI file (ETG.2000). PDO lists come from the dictionary's 1600h.., 1A00h.., 1C12h,
/// 1C13h.
struct DeviceDescription {
  std::uint32_t vendor_id = 0;
  std::string vendor_name;
  std::uint32_t product_code = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial_number = 0;

  std::string order_code;  ///< SII general category: order string; ESI <Type>
  std::string name;        ///< SII string 1; what masters print
  std::string group;       ///< e.g. "Drives"
  std::string image;       ///< name of the group's picture, may be empty

  std::uint16_t station_alias = 0;     ///< SII word 4
  std::uint16_t pdi_control = 0x0005;  ///< SII word 0: PDI type, 05h = SPI slave

  std::uint8_t pdi_configuration = 0;  ///< SII word 1 low byte, register 0x0150
  /// SII word 1 high byte, register 0x0151: what the pins SYNC0/LATCH0 and SYNC1/LATCH1 do and
  /// whether they raise AL events. The units themselves are switched on by bits 10 and 11 of
  /// pdi_control.
  std::uint8_t sync_latch_configuration = 0;
  std::uint16_t sync_pulse_length = 0;  ///< SII word 2, units of 10 ns; 0: acknowledge mode

  MailboxArea receive_mailbox;            ///< SM0, master to device
  MailboxArea transmit_mailbox;           ///< SM1, device to master
  MailboxArea bootstrap_receive_mailbox;  ///< length 0: no bootstrap state
  MailboxArea bootstrap_transmit_mailbox;
  std::uint16_t output_offset = 0;  ///< SM2 start address
  std::uint16_t input_offset = 0;   ///< SM3 start address

  bool coe = false;
  bool foe = false;
  bool eoe = false;
  bool sdo_information = false;
  bool complete_access = false;
  bool pdo_assign = false;         ///< 1C12h and 1C13h can be written
  bool pdo_configuration = false;  ///< 1600h.. and 1A00h.. can be written
  bool distributed_clocks = false;

  std::int16_t ebus_current = 0;                         ///< mA, 0 for a device with its own supply
  std::array<char, 4> port_physics{'Y', 'Y', ' ', ' '};  ///< ESI: Y = MII, K = E-bus, ' ' = none
  std::uint16_t sii_size_kbit = 16;                      ///< EEPROM size
  bool sii_grows = false;  ///< it is larger where its contents need it

  /// False for a coupler, which has neither mailbox nor process data.
  [[nodiscard]] bool exchanges_data() const {
    return receive_mailbox.length != 0 || output_offset != 0 || input_offset != 0;
  }
};

/// What a device with these quirks says about itself in its EEPROM.
[[nodiscard]] inline DeviceDescription with_quirks(DeviceDescription description,
                                                   const dictionary::Quirks& quirks) {
  description.vendor_id = quirks.wrong_vendor.value_or(description.vendor_id);
  description.product_code = quirks.wrong_product.value_or(description.product_code);
  description.revision = quirks.wrong_revision.value_or(description.revision);
  if (!quirks.wrong_name.empty()) {
    description.name = quirks.wrong_name;
    description.order_code = quirks.wrong_name;
  }
  return description;
}

}  // namespace stator::ethercat
