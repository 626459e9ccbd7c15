#include "stator/devices/tmc8461/keys.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include "stator/board/keys/board_keys.hpp"
#include "stator/devices/tmc8461/mfc_configuration_keys.hpp"
#include "stator/devices/tmc8461/sii.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/product/shell/phy_keys.hpp"

namespace stator::devices {

namespace tmc8461 {

namespace {

/// Up to 4 Mbit, as PROM_SIZE allows; a shorter one has no configuration area.
constexpr std::size_t kShortestImage = 128;
constexpr std::size_t kLongestImage = std::size_t{512} * 1024;
constexpr std::int64_t kIdentityWord = std::numeric_limits<std::uint32_t>::max();
constexpr settings::WholeRange kProcessMemory{0x1000, 0x4FFF};

void read_eeprom_image(const settings::KeyWords& key, settings::Reader& reader,
                       Tmc8461Configuration& configuration) {
  const auto file = reader.file(key, "EEPROM image");
  if (!file) {
    return;
  }
  const std::string& content = file->content;
  if (content.size() < kShortestImage || content.size() > kLongestImage ||
      content.size() % 2 != 0) {
    reader.refuse(key.name, file->path + " has " + std::to_string(content.size()) +
                                " bytes; an EEPROM image has an even number from " +
                                std::to_string(kShortestImage) + " to " +
                                std::to_string(kLongestImage));
    return;
  }
  const auto bytes = std::as_bytes(std::span(content));
  configuration.sii.assign(bytes.begin(), bytes.end());
}

void take_over(const BoardIdentity& identity, Tmc8461Configuration& configuration) {
  configuration.vendor_id = identity.vendor_id;
  configuration.product_code = identity.product_code;
  configuration.revision = identity.revision;
  configuration.serial_number = identity.serial_number;
  configuration.station_alias = identity.station_alias;
  configuration.name = identity.name;
  configuration.device_emulation = identity.device_emulation;
}

/// The EEPROM from a configuration of the I/O block, which gives the board's identity, too.
void read_mfc_configuration_file(const settings::KeyWords& key, settings::Reader& reader,
                                 Tmc8461Configuration& configuration) {
  const auto name = reader.file_name(key);
  if (!name) {
    return;
  }
  if (!configuration.sii.empty()) {
    reader.refuse(key.name,
                  R"("mfc" and "sii" both say what the EEPROM contains; give one of them)");
    return;
  }
  const settings::Files* const files = reader.reading().files;
  if (files == nullptr) {
    return;
  }
  settings::Problems& problems = reader.problems();
  const std::string path = files->beside(reader.file(), *name);
  const auto content = files->content(path);
  if (!content) {
    problems.list.emplace_back(path + ": cannot read the configuration: " + content.error() +
                               "; check the path and its permissions");
    return;
  }
  const auto tree = files->tree(*content, path);
  if (!tree) {
    problems.list.push_back(tree.error());
    return;
  }
  const settings::Reading reading{problems, files, path};
  settings::Reader root(reading, "the configuration", *tree);
  const std::size_t before = problems.list.size();
  MfcConfigurationFile file;
  read_mfc_configuration(root, file);
  take_over(file.identity, configuration);
  if (problems.list.size() != before) {
    return;
  }
  try {
    configuration.sii =
        ethercat::compose_sii_image(sii_contents(file.configuration, file.identity));
  } catch (const std::logic_error& error) {  // the EEPROM is too small for it
    reader.refuse(key.name, error.what());
  }
}

void read_wired_board(const settings::KeyWords& key, settings::Reader& reader,
                      Tmc8461Configuration& configuration) {
  if (auto table = reader.section(key)) {
    board::read_board(*table, configuration.board);
  }
}

/// A table whose keys fill members of the configuration itself.
template <const settings::Section<Tmc8461Configuration>& Below>
void read_table_of_chip(const settings::KeyWords& key, settings::Reader& reader,
                        Tmc8461Configuration& configuration) {
  if (auto table = reader.section(key)) {
    settings::read_section(Below, *table, configuration);
  }
}

constexpr std::array kProcessDataRows{
    settings::whole<&Tmc8461Configuration::output_bytes>(
        "outputs", {0, 128, "bytes"}, "In sync manager 2; a buffered one needs at least two"),
    settings::whole<&Tmc8461Configuration::input_bytes>(
        "inputs", {0, 128, "bytes"}, "In sync manager 3; a buffered one needs at least two"),
    settings::whole<&Tmc8461Configuration::output_address>("output_address", kProcessMemory,
                                                           "Where the outputs begin"),
    settings::whole<&Tmc8461Configuration::input_address>("input_address", kProcessMemory,
                                                          "Where the inputs begin")};
constexpr settings::Section<Tmc8461Configuration> kProcessDataKeys{kProcessDataRows};

constexpr std::array kMailboxRows{
    settings::whole<&Tmc8461Configuration::mailbox_bytes>(
        "length", {0, 1486, "bytes"}, "Of each mailbox, from 1000h on; 0: the firmware has none"),
    settings::boolean<&Tmc8461Configuration::coe>(
        "coe", "The mailbox has an object dictionary behind it")};
constexpr settings::Section<Tmc8461Configuration> kMailboxKeys{kMailboxRows};

/// The board's identity, and what else is in its EEPROM.
constexpr std::array kEepromRows{
    settings::custom<Tmc8461Configuration, read_eeprom_image>(
        "sii", "EEPROM image, relative to the rack file"),
    settings::custom<Tmc8461Configuration, read_mfc_configuration_file>(
        "mfc",
        "Configuration of the I/O block, relative to the rack file; the EEPROM is made from it"),
    settings::whole<&Tmc8461Configuration::vendor_id>("vendor", {0, kIdentityWord},
                                                      "Identity in the EEPROM"),
    settings::whole<&Tmc8461Configuration::product_code>("product_code", {0, kIdentityWord},
                                                         "Identity in the EEPROM"),
    settings::whole<&Tmc8461Configuration::revision>("revision", {0, kIdentityWord},
                                                     "Identity in the EEPROM"),
    settings::whole<&Tmc8461Configuration::serial_number>("serial_number", {0, kIdentityWord},
                                                          "Identity in the EEPROM"),
    settings::whole<&Tmc8461Configuration::station_alias>("alias", {0, 0xFFFF},
                                                          "Configured station alias (SII word 4)"),
    settings::text<&Tmc8461Configuration::name>("device_name", "What masters print"),
    settings::whole<&Tmc8461Configuration::pdi_configuration>(
        "pdi_configuration", {0, 0xFF}, "0150h: SPI mode and polarities, which only firmware sees"),
    settings::whole<&Tmc8461Configuration::sync_latch_configuration>(
        "sync_latch_configuration", {0, 0xFF},
        "0151h: what the SYNC pins do, and whether they raise AL events"),
    settings::whole<&Tmc8461Configuration::sync_pulse_length>(
        "sync_pulse_length", {0, 0xFFFF, "10 ns"}, "0982h; 0: the host ends a pulse")};

constexpr std::array kTxShiftWords{settings::Word{"automatic", 0}};

/// Pins, and the straps of the PHYs of both ports.
constexpr std::array kPinRows{
    settings::boolean<&Tmc8461Configuration::device_emulation>(
        "device_emulation",
        "Pin PDI_EMULATION; true: the AL state follows the master without a controller"),
    settings::boolean<&Tmc8461Configuration::shared_bus>("shared_bus", "Pin PDI_SHARED_BUS"),
    settings::boolean<&Tmc8461Configuration::phy_offset>("phy_offset", "Pin PHY_OFFSET"),
    settings::boolean<&Tmc8461Configuration::large_eeprom>("large_eeprom",
                                                           "Pin PROM_SIZE: 32 kbit instead of 16"),
    settings::boolean<&Tmc8461Configuration::reset_loop>(
        "reset_loop", "RESET_OUT leads back to NRESET; false: a reset by register is only shown"),
    settings::boolean<&Tmc8461Configuration::emergency_released>(
        "mfc_nes", "Pin MFC_NES is driven high; false: open, which is an emergency"),
    settings::whole_or_word<&Tmc8461Configuration::tx_shift>(
        "tx_shift", {0, 3}, kTxShiftWords,
        "Pins MII_TX_SHIFT by which both ports send later, steps of 10 ns; automatic: the chip "
        "finds them itself")};

constexpr std::array kSurroundingsRows{
    settings::boolean<&Tmc8461Configuration::acknowledge_by_write>(
        "acknowledge_by_write", "014Eh bit 0: the host acknowledges events by writing"),
    settings::custom<Tmc8461Configuration, read_table_of_chip<kProcessDataKeys>>(
        "process_data", "Process data of the EEPROM"),
    settings::custom<Tmc8461Configuration, read_table_of_chip<kMailboxKeys>>(
        "mailbox", "Mailboxes of the EEPROM"),
    settings::custom<Tmc8461Configuration, read_wired_board>(
        "board", "What is wired to the chip's I/O pins, any number")};

constexpr auto kChipRows = settings::rows(
    kEepromRows, kPinRows, product::phy_rows<Tmc8461Configuration>(), kSurroundingsRows);

}  // namespace

}  // namespace tmc8461

constinit const settings::Section<Tmc8461Configuration> kTmc8461Keys{tmc8461::kChipRows};

}  // namespace stator::devices
