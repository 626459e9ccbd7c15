#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::ethercat {

// The slave information interface: contents of the EEPROM beside the controller (ETG.2010), built
// from a device's description and the default PDO mapping of its dictionary.

/// Word addresses of the fixed part (ETG.2010 table 2).
namespace sii_word {
inline constexpr std::size_t kPdiControl = 0x00;
inline constexpr std::size_t kPdiConfiguration = 0x01;
inline constexpr std::size_t kSyncPulseLength = 0x02;
inline constexpr std::size_t kStationAlias = 0x04;
inline constexpr std::size_t kChecksum = 0x07;
inline constexpr std::size_t kVendorId = 0x08;
inline constexpr std::size_t kProductCode = 0x0A;
inline constexpr std::size_t kRevision = 0x0C;
inline constexpr std::size_t kSerialNumber = 0x0E;
inline constexpr std::size_t kBootstrapMailbox = 0x14;
inline constexpr std::size_t kStandardMailbox = 0x18;
inline constexpr std::size_t kMailboxProtocols = 0x1C;
inline constexpr std::size_t kSize = 0x3E;
inline constexpr std::size_t kVersion = 0x3F;
inline constexpr std::size_t kFirstCategory = 0x40;
}  // namespace sii_word

/// Category types (ETG.2010 table 4).
enum class SiiCategory : std::uint16_t {
  parameter_ram = 1,  ///< of the TMC8461: copied to 0x0580 if it is the first
  strings = 10,
  general = 30,
  fmmu = 40,
  sync_manager = 41,
  tx_pdo = 50,
  rx_pdo = 51,
  distributed_clock = 60,
  end = 0xFFFF,
};

/// Says the EEPROM's size in the image and fills it with FFh behind the contents. It has so many
/// `kbit`, or if it `grows` twice that until the contents fit. Throws std::logic_error if they do
/// not, naming both sizes and the device's `name`.
void fill_eeprom(std::vector<std::byte>& image, const std::string& name, std::uint16_t kbit,
                 bool grows);

/// What the image says beyond the description.
struct SiiOptions {
  bool device_identification = false;  ///< explicit device identification by AL status code
};

/// The complete image, padded with FFh to the EEPROM's size. Throws std::logic_error if the
/// contents do not fit description.sii_size_kbit, naming both sizes.
[[nodiscard]] std::vector<std::byte> build_sii_image(const DeviceDescription& description,
                                                     const dictionary::Dictionary& dictionary,
                                                     const SiiOptions& options = {});

/// One PDO as a category lists it.
struct SiiPdo {
  struct Entry {
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
    std::uint8_t data_type = 0;
    std::uint8_t bits = 0;
    std::string name;
  };
  std::uint16_t index = 0;
  std::uint8_t sync_manager = 0;  ///< FFh: not assigned by default
  std::string name;
  std::vector<Entry> entries{};
};

/// One sync manager as a category lists it.
struct SiiSyncManager {
  std::uint16_t start = 0;
  std::uint16_t length = 0;
  std::uint8_t control = 0;
  std::uint8_t enable = 0;
  std::uint8_t type = 0;  ///< 1, 2 mailbox out, in; 3, 4 process data out, in
};

/// What a master learns from an image.
struct SiiContents {
  std::uint32_t vendor_id = 0;
  std::uint32_t product_code = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial_number = 0;
  std::uint16_t station_alias = 0;
  std::uint16_t pdi_control = 0;        ///< word 0
  std::uint16_t pdi_configuration = 0;  ///< word 1
  std::uint16_t sync_pulse_length = 0;  ///< word 2, 10 ns
  std::uint16_t size_kbit = 16;         ///< of the EEPROM
  bool grows = false;                   ///< it is larger where its contents need it
  MailboxArea receive_mailbox;
  MailboxArea transmit_mailbox;
  MailboxArea bootstrap_receive_mailbox;
  MailboxArea bootstrap_transmit_mailbox;
  std::uint16_t mailbox_protocols = 0;
  std::vector<std::string> strings;  ///< string 1 first
  std::string group;
  std::string order_code;
  std::string name;
  std::uint8_t coe_details = 0;
  std::vector<std::uint8_t> fmmu_usage;
  std::vector<SiiSyncManager> sync_managers;
  std::vector<SiiPdo> tx_pdos;
  std::vector<SiiPdo> rx_pdos;
  std::vector<std::byte> parameter_ram;  ///< category 1
  bool distributed_clocks = false;       ///< has operation modes with them
};

/// The image with these contents, padded with FFh to the EEPROM's size; `strings` follows from the
/// names. Throws std::logic_error if they do not fit size_kbit, naming both sizes.
[[nodiscard]] std::vector<std::byte> compose_sii_image(const SiiContents& contents);

/// Reads an image; empty if it is truncated, its checksum is wrong or a category leaves it.
[[nodiscard]] std::optional<SiiContents> parse_sii_image(std::span<const std::byte> image);

}  // namespace stator::ethercat
