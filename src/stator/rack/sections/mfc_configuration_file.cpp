#include "stator/rack/sections/mfc_configuration_file.hpp"

#include <array>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>

#include <fmt/format.h>

#include "stator/mfc/block/memory_map.hpp"
#include "stator/mfc/pins/crossbar.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/rack/toml/toml_section.hpp"
#include "stator/rack/world/text.hpp"

namespace stator::rack {

namespace {

constexpr std::int64_t kMost32 = 0xFFFFFFFF;
constexpr std::int64_t kMost16 = 0xFFFF;
constexpr unsigned kBuffers = 3;  ///< of the sync manager in front of a block

std::set<std::string> signal_names() {
  std::set<std::string> names;
  for (const mfc::SignalDescription& row : mfc::signal_table()) {
    names.emplace(row.name);
  }
  return names;
}

/// Code of a signal by its name, which is known to exist.
std::uint8_t signal_code(const std::string& name) {
  for (const mfc::SignalDescription& row : mfc::signal_table()) {
    if (row.name == name) {
      return static_cast<std::uint8_t>(row.signal);
    }
  }
  return 0;
}

template <typename T>
void take(const std::optional<std::int64_t>& value, T& target) {
  if (value) {
    target = static_cast<T>(*value);
  }
}

void read_identity(TomlSection section, devices::tmc8461::BoardIdentity& identity) {
  take(section.integer("vendor_id", 0, kMost32), identity.vendor_id);
  identity.vendor_name = section.text("vendor").value_or(identity.vendor_name);
  take(section.integer("product_code", 0, kMost32), identity.product_code);
  take(section.integer("revision", 0, kMost32), identity.revision);
  take(section.integer("serial_number", 0, kMost32), identity.serial_number);
  identity.name = section.text("name").value_or(identity.name);
  identity.order_code = section.text("order_code").value_or(identity.order_code);
  identity.group = section.text("group").value_or(identity.group);
  take(section.integer("station_alias", 0, kMost16), identity.station_alias);
  identity.device_emulation =
      section.boolean("device_emulation").value_or(identity.device_emulation);
  identity.distributed_clocks =
      section.boolean("distributed_clocks").value_or(identity.distributed_clocks);
  take(section.integer("sync_pulse_length", 0, kMost16), identity.sync_pulse_length);
  take(section.integer("eeprom_kbit", 2, 4096), identity.sii_size_kbit);
  section.finish();
}

void read_pins(TomlSection section, mfc::Configuration& configuration) {
  const std::set<std::string> signals = signal_names();
  for (std::size_t line = 0; line < mfc::kLines; ++line) {
    if (const auto name = section.choice(std::string(mfc::kLineNames[line]), signals)) {
      configuration.set_signal(line, signal_code(*name));
    }
  }
  section.finish();
}

/// The bits of HVIO_CFG for a list of high-voltage pins, from bit `shift` on.
std::uint32_t pin_bits(TomlSection& section, const std::string& key, unsigned shift) {
  std::uint32_t bits = 0;
  for (const std::string& name : section.texts(key).value_or(std::vector<std::string>())) {
    std::size_t pin = 0;
    while (pin < mfc::kHighVoltageLines && mfc::kLineNames[mfc::kFirstHighVoltage + pin] != name) {
      ++pin;
    }
    if (pin == mfc::kHighVoltageLines) {
      section.refuse(
          key, fmt::format("\"{}\" is no high-voltage pin; there are MFC_HV0 to MFC_HV7", name));
      continue;
    }
    bits |= 1U << (shift + pin);
  }
  return bits;
}

std::string pair_name(const mfc::DifferentialPair& pair) {
  return fmt::format("{}-{}", mfc::kLineNames[pair.positive], mfc::kLineNames[pair.negative]);
}

std::uint32_t pair_bits(TomlSection& section, std::uint32_t slow,
                        const mfc::Configuration& configuration) {
  std::uint32_t bits = 0;
  for (const std::string& name :
       section.texts("differential").value_or(std::vector<std::string>())) {
    std::set<std::string> known;
    std::size_t found = mfc::kDifferentialPairs.size();
    for (std::size_t i = 0; i < mfc::kDifferentialPairs.size(); ++i) {
      known.insert(pair_name(mfc::kDifferentialPairs[i]));
      found = pair_name(mfc::kDifferentialPairs[i]) == name ? i : found;
    }
    if (found == mfc::kDifferentialPairs.size()) {
      section.refuse("differential",
                     fmt::format("\"{}\" is no pair; there are {}", name, fmt::join(known, ", ")));
      continue;
    }
    const mfc::DifferentialPair& pair = mfc::kDifferentialPairs[found];
    const auto slow_at = [slow](std::size_t line) {
      return (slow >> (line - mfc::kFirstHighVoltage) & 1U) != 0;
    };
    if (slow_at(pair.positive) != slow_at(pair.negative)) {
      section.refuse(
          "differential",
          fmt::format("the pins of \"{}\" have different slopes; name both or neither in "
                      "\"slow_slope\"",
                      name));
    }
    if (configuration.signal(pair.positive) != 0) {
      section.refuse("differential",
                     fmt::format("the signal at {} would be ignored; the pair is read at {}",
                                 mfc::kLineNames[pair.positive], mfc::kLineNames[pair.negative]));
    }
    bits |= 1U << (24 + found);
  }
  return bits;
}

void read_high_voltage(TomlSection section, mfc::Configuration& configuration) {
  const std::uint32_t slow = pin_bits(section, "slow_slope", 0);
  configuration.set_high_voltage(slow | pin_bits(section, "weak_high", 8) |
                                 pin_bits(section, "weak_low", 16) |
                                 pair_bits(section, slow, configuration));
  section.finish();
}

/// The code of one of four values; 0 if the key is missing.
unsigned code_of(TomlSection& section, const std::string& key,
                 const std::array<std::int64_t, 4>& values) {
  const auto value = section.integer(key, 0, kMost16);
  for (unsigned code = 0; value && code < values.size(); ++code) {
    if (values[code] == *value) {
      return code;
    }
  }
  if (value) {
    section.refuse(key, fmt::format("\"{}\" is {}; it must be one of: {}", key, *value,
                                    fmt::join(values, ", ")));
  }
  return 0;
}

unsigned regulator_bits(TomlSection section, bool adjustable) {
  unsigned bits = code_of(section, "saw_frequency_khz", {250, 125, 500, 1000}) |
                  code_of(section, "amplification_percent", {100, 150, 200, 50}) << 2 |
                  code_of(section, "damping_percent", {100, 150, 200, 50}) << 4;
  bits |= section.boolean("over_current_protection").value_or(true) ? 0U : 1U << 6;
  if (adjustable) {
    bits |= section.boolean("enabled").value_or(true) ? 0U : 1U << 7;
  }
  section.finish();
  return bits;
}

void read_regulators(TomlSection section, mfc::Configuration& configuration) {
  unsigned bits = 0;
  if (auto fixed = section.section("fixed")) {
    bits |= regulator_bits(std::move(*fixed), false);
  }
  if (auto adjustable = section.section("adjustable")) {
    bits |= regulator_bits(std::move(*adjustable), true) << 8;
  }
  configuration.set_regulators(static_cast<std::uint16_t>(bits));
  section.finish();
}

void read_registers(TomlSection section, mfc::Direction direction,
                    mfc::Configuration& configuration) {
  const std::set<std::string> triggers(mfc::kTriggerNames.begin(), mfc::kTriggerNames.end());
  for (const mfc::Register& entry : mfc::kRegisters) {
    if (entry.direction != direction || !entry.mappable()) {
      continue;
    }
    const auto name = section.choice(std::string(entry.name), triggers);
    for (std::size_t code = 0; name && code < mfc::kTriggerCount; ++code) {
      if (mfc::kTriggerNames[code] == *name) {
        configuration.set_mapping(entry.number, {true, static_cast<mfc::Trigger>(code)});
      }
    }
  }
  section.finish();
}

void read_block(TomlSection section, unsigned block, mfc::Configuration& configuration) {
  const auto start =
      section.integer("start", mfc::MemoryMap::kMemoryBegin, mfc::MemoryMap::kMemoryEnd - 1);
  if (!start) {
    section.fail("start",
                 "\"start\" is missing: the block's address in process data RAM, 0x1000 "
                 "to 0x4FFF");
  }
  configuration.set_block_start(block, static_cast<std::uint16_t>(*start));
  if (auto registers = section.section("registers")) {
    read_registers(std::move(*registers), block == 0 ? mfc::Direction::write : mfc::Direction::read,
                   configuration);
  }
  const mfc::MemoryMap map(configuration);
  const std::uint32_t length = map.block(block).length;
  const std::uint32_t end = static_cast<std::uint32_t>(*start) + kBuffers * length;
  if (end > mfc::MemoryMap::kMemoryEnd) {
    section.refuse("start",
                   fmt::format("the block takes three buffers of {} bytes and would end at "
                               "{:#06x}, behind the process data RAM (0x4fff)",
                               length, end - 1));
  }
  if (block == 1) {
    const mfc::MemoryMap::Block& other = map.block(0);
    const std::uint32_t other_end = other.start + kBuffers * other.length;
    if (length != 0 && other.length != 0 && other.start < end &&
        static_cast<std::uint32_t>(*start) < other_end) {
      section.refuse(
          "start", fmt::format("the block, {:#06x} to {:#06x} with its three buffers, overlaps the "
                               "one of [write], {:#06x} to {:#06x}",
                               *start, end - 1, other.start, other_end - 1));
    }
  }
  section.finish();
}

}  // namespace

MfcConfigurationFile parse_mfc_configuration(std::string_view text, const std::string& name,
                                             RackFileErrors* errors) {
  toml::table table;
  try {
    table = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    throw RackFileError(name, place.line, place.column, "", std::string(error.description()));
  }
  TomlSection root(name, "the configuration", table, errors);
  MfcConfigurationFile content;
  if (auto section = root.section("identity")) {
    read_identity(std::move(*section), content.identity);
  }
  if (auto section = root.section("pins")) {
    read_pins(std::move(*section), content.configuration);
  }
  if (auto section = root.section("high_voltage")) {
    read_high_voltage(std::move(*section), content.configuration);
  }
  if (auto section = root.section("regulators")) {
    read_regulators(std::move(*section), content.configuration);
  }
  if (auto section = root.section("write")) {
    root.attempt([&] { read_block(std::move(*section), 0, content.configuration); });
  }
  if (auto section = root.section("read")) {
    root.attempt([&] { read_block(std::move(*section), 1, content.configuration); });
  }
  root.finish();
  return content;
}

MfcConfigurationFile load_mfc_configuration(const std::string& path, RackFileErrors* errors) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    throw RackFileError(
        fmt::format("{}: cannot read the configuration: {}; check the path and its "
                    "permissions",
                    path, std::generic_category().message(errno)));
  }
  return parse_mfc_configuration(text, path, errors);
}

}  // namespace stator::rack
