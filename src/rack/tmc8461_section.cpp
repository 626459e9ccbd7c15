#include "rack/tmc8461_section.hpp"

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

#include "devices/tmc8461/sii.hpp"
#include "ethercat/sii_image.hpp"
#include "rack/board_section.hpp"
#include "rack/mfc_configuration_file.hpp"

namespace stator::rack {

namespace {

using devices::Tmc8461Configuration;

/// Up to 4 Mbit, as PROM_SIZE allows; a shorter one has no configuration area.
constexpr std::size_t kShortestImage = 128;
constexpr std::size_t kLongestImage = std::size_t{512} * 1024;
constexpr std::int64_t kProcessMemory = 0x1000;
constexpr std::int64_t kProcessMemoryEnd = 0x4FFF;

template <typename Integer>
void set_integer(TomlSection& section, const char* key, std::int64_t minimum, std::int64_t maximum,
                 Integer& target) {
  if (const auto value = section.integer(key, minimum, maximum)) {
    target = static_cast<Integer>(*value);
  }
}

/// Keys that are on or off.
struct Switch {
  const char* key;
  bool Tmc8461Configuration::*option;
};
constexpr std::array kPins{
    Switch{"device_emulation", &Tmc8461Configuration::device_emulation},
    Switch{"shared_bus", &Tmc8461Configuration::shared_bus},
    Switch{"phy_offset", &Tmc8461Configuration::phy_offset},
    Switch{"large_eeprom", &Tmc8461Configuration::large_eeprom},
    Switch{"reset_loop", &Tmc8461Configuration::reset_loop},
    Switch{"mfc_nes", &Tmc8461Configuration::emergency_released},
};

/// A file named in the rack file, relative to it.
std::string beside(const TomlSection& section, const std::string& name) {
  return (std::filesystem::path(section.file()).parent_path() / name).lexically_normal().string();
}

/// The EEPROM from a configuration of the I/O block; it says as well who the board is.
void read_mfc_configuration(TomlSection& section, Tmc8461Configuration& configuration) {
  const auto name = section.text("mfc");
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
  const auto name = section.text("sii");
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
  set_integer(section, "outputs", 0, 128, configuration.output_bytes);
  set_integer(section, "inputs", 0, 128, configuration.input_bytes);
  set_integer(section, "output_address", kProcessMemory, kProcessMemoryEnd,
              configuration.output_address);
  set_integer(section, "input_address", kProcessMemory, kProcessMemoryEnd,
              configuration.input_address);
  section.finish();
}

void read_mailbox(TomlSection section, Tmc8461Configuration& configuration) {
  set_integer(section, "length", 0, 1486, configuration.mailbox_bytes);
  configuration.coe = section.boolean("coe").value_or(configuration.coe);
  section.finish();
}

}  // namespace

void read_tmc8461(TomlSection& section, Tmc8461Configuration& configuration) {
  constexpr std::int64_t kWord = std::numeric_limits<std::uint32_t>::max();
  section.attempt([&] { read_image(section, configuration.sii); });
  section.attempt([&] { read_mfc_configuration(section, configuration); });
  set_integer(section, "vendor", 0, kWord, configuration.vendor_id);
  set_integer(section, "product_code", 0, kWord, configuration.product_code);
  set_integer(section, "revision", 0, kWord, configuration.revision);
  set_integer(section, "serial_number", 0, kWord, configuration.serial_number);
  set_integer(section, "alias", 0, 0xFFFF, configuration.station_alias);
  configuration.name = section.text("device_name").value_or(configuration.name);
  set_integer(section, "pdi_configuration", 0, 0xFF, configuration.pdi_configuration);
  set_integer(section, "sync_latch_configuration", 0, 0xFF, configuration.sync_latch_configuration);
  set_integer(section, "sync_pulse_length", 0, 0xFFFF, configuration.sync_pulse_length);
  for (const Switch& entry : kPins) {
    bool& option = configuration.*entry.option;
    option = section.boolean(entry.key).value_or(option);
  }
  configuration.acknowledge_by_write =
      section.boolean("acknowledge_by_write").value_or(configuration.acknowledge_by_write);
  if (auto process_data = section.section("process_data")) {
    read_process_data(std::move(*process_data), configuration);
  }
  if (auto mailbox = section.section("mailbox")) {
    read_mailbox(std::move(*mailbox), configuration);
  }
  if (auto board = section.section("board")) {
    read_board(*board, configuration.board);
  }
}

}  // namespace stator::rack
