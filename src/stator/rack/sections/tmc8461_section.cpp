#include "stator/rack/sections/tmc8461_section.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/devices/tmc8461/sii.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/rack/sections/board_section.hpp"
#include "stator/rack/sections/mfc_configuration_file.hpp"
#include "stator/rack/sections/phy_keys.hpp"

namespace stator::rack {

namespace {

using devices::Tmc8461Configuration;

/// Up to 4 Mbit, as PROM_SIZE allows; a shorter one has no configuration area.
constexpr std::size_t kShortestImage = 128;
constexpr std::size_t kLongestImage = std::size_t{512} * 1024;
constexpr std::int64_t kProcessMemory = 0x1000;
constexpr std::int64_t kProcessMemoryEnd = 0x4FFF;

/// Keys that are on or off.
struct Switch {
  const char* key;
  const char* summary;
  bool Tmc8461Configuration::*option;
};
constexpr std::array kPins{
    Switch{"device_emulation",
           "Pin PDI_EMULATION; true: the AL state follows the master without a controller",
           &Tmc8461Configuration::device_emulation},
    Switch{"shared_bus", "Pin PDI_SHARED_BUS", &Tmc8461Configuration::shared_bus},
    Switch{"phy_offset", "Pin PHY_OFFSET", &Tmc8461Configuration::phy_offset},
    Switch{"large_eeprom", "Pin PROM_SIZE: 32 kbit instead of 16",
           &Tmc8461Configuration::large_eeprom},
    Switch{"reset_loop", "RESET_OUT leads back to NRESET; false: a reset by register is only shown",
           &Tmc8461Configuration::reset_loop},
    Switch{"mfc_nes", "Pin MFC_NES is driven high; false: open, which is an emergency",
           &Tmc8461Configuration::emergency_released},
};

/// A file named in the rack file, relative to it.
std::string beside(const TomlSection& section, const std::string& name) {
  return (std::filesystem::path(section.file()).parent_path() / name).lexically_normal().string();
}

/// The EEPROM from a configuration of the I/O block; it says as well who the board is.
void read_mfc_configuration(TomlSection& section, Tmc8461Configuration& configuration) {
  const auto name = section.text(
      {"mfc",
       "Configuration of the I/O block, relative to the rack file; the EEPROM is made from it"});
  if (!name) {
    return;
  }
  if (!configuration.sii.empty()) {
    section.refuse("mfc", R"("mfc" and "sii" both say what the EEPROM contains; give one of them)");
    return;
  }
  const MfcConfigurationFile file =
      load_mfc_configuration(beside(section, *name), section.errors());
  configuration.sii = ethercat::compose_sii_image(
      devices::tmc8461::sii_contents(file.configuration, file.identity));
  configuration.vendor_id = file.identity.vendor_id;
  configuration.product_code = file.identity.product_code;
  configuration.revision = file.identity.revision;
  configuration.serial_number = file.identity.serial_number;
  configuration.station_alias = file.identity.station_alias;
  configuration.name = file.identity.name;
  configuration.device_emulation = file.identity.device_emulation;
}

void read_image(TomlSection& section, std::vector<std::byte>& image) {
  const auto name = section.text({"sii", "EEPROM image, relative to the rack file"});
  if (!name) {
    return;
  }
  const std::string path = beside(section, *name);
  std::ifstream file(path, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    section.fail("sii", fmt::format("cannot read the EEPROM image {}: {}; check the path and its "
                                    "permissions",
                                    path, std::generic_category().message(errno)));
  }
  if (content.size() < kShortestImage || content.size() > kLongestImage ||
      content.size() % 2 != 0) {
    section.fail("sii", fmt::format("{} has {} bytes; an EEPROM image has an even number from {} "
                                    "to {}",
                                    path, content.size(), kShortestImage, kLongestImage));
  }
  const auto bytes = std::as_bytes(std::span(content));
  image.assign(bytes.begin(), bytes.end());
}

void read_process_data(TomlSection section, Tmc8461Configuration& configuration) {
  section.integer({"outputs", "In sync manager 2; a buffered one needs at least two", "bytes"}, 0,
                  128, configuration.output_bytes);
  section.integer({"inputs", "In sync manager 3; a buffered one needs at least two", "bytes"}, 0,
                  128, configuration.input_bytes);
  section.integer({"output_address", "Where the outputs begin"}, kProcessMemory, kProcessMemoryEnd,
                  configuration.output_address);
  section.integer({"input_address", "Where the inputs begin"}, kProcessMemory, kProcessMemoryEnd,
                  configuration.input_address);
  section.finish();
}

void read_mailbox(TomlSection section, Tmc8461Configuration& configuration) {
  section.integer({"length", "Of each mailbox, from 1000h on; 0: the firmware has none", "bytes"},
                  0, 1486, configuration.mailbox_bytes);
  section.boolean({"coe", "The mailbox has an object dictionary behind it"}, configuration.coe);
  section.finish();
}

/// How chip and PHYs are connected; the straps MII_TX_SHIFT are those of both ports.
void read_straps(TomlSection& section, Tmc8461Configuration& configuration) {
  if (section.is_text("tx_shift")) {
    static_cast<void>(section.choice({"tx_shift",
                                      "Pins MII_TX_SHIFT by which both ports send later, steps of "
                                      "10 ns; automatic: the chip finds them itself"},
                                     {"automatic"}));
    configuration.tx_shift.reset();
  } else if (const auto steps = section.integer("tx_shift", 0, 3)) {
    configuration.tx_shift = static_cast<std::uint8_t>(*steps);
  }
  read_phys(section, configuration);
}

}  // namespace

void read_tmc8461(TomlSection& section, Tmc8461Configuration& configuration) {
  constexpr std::int64_t kWord = std::numeric_limits<std::uint32_t>::max();
  section.attempt([&] { read_image(section, configuration.sii); });
  section.attempt([&] { read_mfc_configuration(section, configuration); });
  section.integer({"vendor", "Identity in the EEPROM"}, 0, kWord, configuration.vendor_id);
  section.integer({"product_code", "Identity in the EEPROM"}, 0, kWord, configuration.product_code);
  section.integer({"revision", "Identity in the EEPROM"}, 0, kWord, configuration.revision);
  section.integer({"serial_number", "Identity in the EEPROM"}, 0, kWord,
                  configuration.serial_number);
  section.integer({"alias", "Configured station alias (SII word 4)"}, 0, 0xFFFF,
                  configuration.station_alias);
  section.text({"device_name", "What masters print"}, configuration.name);
  section.integer({"pdi_configuration", "0150h: SPI mode and polarities, which only firmware sees"},
                  0, 0xFF, configuration.pdi_configuration);
  section.integer({"sync_latch_configuration",
                   "0151h: what the SYNC pins do, and whether they raise AL events"},
                  0, 0xFF, configuration.sync_latch_configuration);
  section.integer({"sync_pulse_length", "0982h; 0: the host ends a pulse", "10 ns"}, 0, 0xFFFF,
                  configuration.sync_pulse_length);
  for (const Switch& entry : kPins) {
    section.boolean({entry.key, entry.summary}, configuration.*entry.option);
  }
  read_straps(section, configuration);
  section.boolean({"acknowledge_by_write", "014Eh bit 0: the host acknowledges events by writing"},
                  configuration.acknowledge_by_write);
  if (auto process_data = section.section({"process_data", "Process data of the EEPROM"})) {
    read_process_data(std::move(*process_data), configuration);
  }
  if (auto mailbox = section.section({"mailbox", "Mailboxes of the EEPROM"})) {
    read_mailbox(std::move(*mailbox), configuration);
  }
  if (auto board = section.section({"board", "What is wired to the chip's I/O pins, any number"})) {
    read_board(*board, configuration.board);
  }
}

}  // namespace stator::rack
