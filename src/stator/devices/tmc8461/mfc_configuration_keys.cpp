#include "stator/devices/tmc8461/mfc_configuration_keys.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "stator/devices/tmc8461/hexadecimal.hpp"
#include "stator/mfc/block/memory_map.hpp"
#include "stator/mfc/pins/crossbar.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/registers/register_map.hpp"
#include "stator/settings/key.hpp"
#include "stator/settings/words.hpp"

namespace stator::devices::tmc8461 {

namespace {

using settings::KeyWords;
using settings::Reader;

constexpr std::int64_t kMost32 = 0xFFFFFFFF;
constexpr std::int64_t kMost16 = 0xFFFF;
constexpr unsigned kBuffers = 3;  ///< of the sync manager in front of a block

constexpr std::array kIdentityRows{
    settings::whole<&BoardIdentity::vendor_id>("vendor_id", {0, kMost32}, ""),
    settings::text<&BoardIdentity::vendor_name>("vendor", ""),
    settings::whole<&BoardIdentity::product_code>("product_code", {0, kMost32}, ""),
    settings::whole<&BoardIdentity::revision>("revision", {0, kMost32}, ""),
    settings::whole<&BoardIdentity::serial_number>("serial_number", {0, kMost32}, ""),
    settings::text<&BoardIdentity::name>("name", ""),
    settings::text<&BoardIdentity::order_code>("order_code", ""),
    settings::text<&BoardIdentity::group>("group", ""),
    settings::whole<&BoardIdentity::station_alias>("station_alias", {0, kMost16}, ""),
    settings::boolean<&BoardIdentity::device_emulation>("device_emulation", ""),
    settings::boolean<&BoardIdentity::distributed_clocks>("distributed_clocks", ""),
    settings::whole<&BoardIdentity::sync_pulse_length>("sync_pulse_length", {0, kMost16}, ""),
    settings::whole<&BoardIdentity::sii_size_kbit>("eeprom_kbit", {2, 4096}, "")};
constexpr settings::Section<BoardIdentity> kIdentityKeys{kIdentityRows};

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

void read_pins(const KeyWords& key, Reader& reader, MfcConfigurationFile& file) {
  auto table = reader.section(key);
  if (!table) {
    return;
  }
  const std::set<std::string> signals = signal_names();
  for (std::size_t line = 0; line < mfc::kLines; ++line) {
    if (const auto name = table->choice(mfc::kLineNames[line], signals)) {
      file.configuration.set_signal(line, signal_code(*name));
    }
  }
  table->finish();
}

/// The bits of HVIO_CFG for a list of high-voltage pins, from bit `shift` on.
std::uint32_t pin_bits(Reader& reader, const std::string& key, unsigned shift) {
  std::uint32_t bits = 0;
  for (const std::string& name : reader.texts(key).value_or(std::vector<std::string>())) {
    std::size_t pin = 0;
    while (pin < mfc::kHighVoltageLines && mfc::kLineNames[mfc::kFirstHighVoltage + pin] != name) {
      ++pin;
    }
    if (pin == mfc::kHighVoltageLines) {
      reader.refuse(key, '"' + name + "\" is no high-voltage pin; there are MFC_HV0 to MFC_HV7");
      continue;
    }
    bits |= 1U << (shift + pin);
  }
  return bits;
}

std::string pair_name(const mfc::DifferentialPair& pair) {
  return std::string(mfc::kLineNames[pair.positive]) + '-' +
         std::string(mfc::kLineNames[pair.negative]);
}

std::uint32_t pair_bits(Reader& reader, std::uint32_t slow,
                        const mfc::Configuration& configuration) {
  std::uint32_t bits = 0;
  for (const std::string& name :
       reader.texts("differential").value_or(std::vector<std::string>())) {
    std::set<std::string> known;
    std::size_t found = mfc::kDifferentialPairs.size();
    for (std::size_t i = 0; i < mfc::kDifferentialPairs.size(); ++i) {
      known.insert(pair_name(mfc::kDifferentialPairs[i]));
      found = pair_name(mfc::kDifferentialPairs[i]) == name ? i : found;
    }
    if (found == mfc::kDifferentialPairs.size()) {
      reader.refuse("differential",
                    '"' + name + "\" is no pair; there are " + settings::joined(known));
      continue;
    }
    const mfc::DifferentialPair& pair = mfc::kDifferentialPairs[found];
    const auto slow_at = [slow](std::size_t line) {
      return (slow >> (line - mfc::kFirstHighVoltage) & 1U) != 0;
    };
    if (slow_at(pair.positive) != slow_at(pair.negative)) {
      reader.refuse("differential", "the pins of \"" + name +
                                        "\" have different slopes; name both or neither in "
                                        "\"slow_slope\"");
    }
    if (configuration.signal(pair.positive) != 0) {
      reader.refuse("differential", "the signal at " + std::string(mfc::kLineNames[pair.positive]) +
                                        " would be ignored; the pair is read at " +
                                        std::string(mfc::kLineNames[pair.negative]));
    }
    bits |= 1U << (24 + found);
  }
  return bits;
}

void read_high_voltage(const KeyWords& key, Reader& reader, MfcConfigurationFile& file) {
  auto table = reader.section(key);
  if (!table) {
    return;
  }
  const std::uint32_t slow = pin_bits(*table, "slow_slope", 0);
  const std::uint32_t high = pin_bits(*table, "weak_high", 8);
  const std::uint32_t low = pin_bits(*table, "weak_low", 16);
  file.configuration.set_high_voltage(slow | high | low |
                                      pair_bits(*table, slow, file.configuration));
  table->finish();
}

/// Of one regulator as BUCK_CONV_CFG has them.
struct RegulatorCodes {
  unsigned saw_frequency = 0;
  unsigned amplification = 0;
  unsigned damping = 0;
  bool over_current_protection = true;
  bool enabled = true;

  [[nodiscard]] unsigned bits() const {
    return saw_frequency | amplification << 2 | damping << 4 |
           (over_current_protection ? 0U : 1U << 6) | (enabled ? 0U : 1U << 7);
  }
};
struct RegulatorPair {
  RegulatorCodes fixed;
  RegulatorCodes adjustable;
};

/// By their codes.
constexpr std::array<std::int64_t, 4> kSawKilohertz{250, 125, 500, 1000};
constexpr std::array<std::int64_t, 4> kGainPercent{100, 150, 200, 50};

/// The code of one of four values.
template <auto Member, const std::array<std::int64_t, 4>& Values>
void read_code(const KeyWords& key, Reader& reader, RegulatorCodes& regulator) {
  const auto value = reader.integer(key, 0, kMost16);
  if (!value) {
    return;
  }
  std::string known;
  for (unsigned code = 0; code < Values.size(); ++code) {
    if (Values[code] == *value) {
      regulator.*Member = code;
      return;
    }
    known += (known.empty() ? "" : ", ") + std::to_string(Values[code]);
  }
  reader.refuse(key.name, '"' + key.name + "\" is " + std::to_string(*value) +
                              "; it must be one of: " + known);
}

constexpr std::array kFixedRows{
    settings::custom<RegulatorCodes, read_code<&RegulatorCodes::saw_frequency, kSawKilohertz>>(
        "saw_frequency_khz", ""),
    settings::custom<RegulatorCodes, read_code<&RegulatorCodes::amplification, kGainPercent>>(
        "amplification_percent", ""),
    settings::custom<RegulatorCodes, read_code<&RegulatorCodes::damping, kGainPercent>>(
        "damping_percent", ""),
    settings::boolean<&RegulatorCodes::over_current_protection>("over_current_protection", "")};
constexpr auto kAdjustableRows = settings::rows(
    kFixedRows, std::array{settings::boolean<&RegulatorCodes::enabled>("enabled", "")});
constexpr settings::Section<RegulatorCodes> kFixedKeys{kFixedRows};
constexpr settings::Section<RegulatorCodes> kAdjustableKeys{kAdjustableRows};

constexpr std::array kRegulatorRows{
    settings::section<kFixedKeys, &RegulatorPair::fixed>("fixed", ""),
    settings::section<kAdjustableKeys, &RegulatorPair::adjustable>("adjustable", "")};
constexpr settings::Section<RegulatorPair> kRegulatorKeys{kRegulatorRows};

void read_regulators(const KeyWords& key, Reader& reader, MfcConfigurationFile& file) {
  auto table = reader.section(key);
  if (!table) {
    return;
  }
  RegulatorPair regulators;
  settings::read_section(kRegulatorKeys, *table, regulators);
  file.configuration.set_regulators(
      static_cast<std::uint16_t>(regulators.fixed.bits() | regulators.adjustable.bits() << 8));
}

void read_registers(Reader& reader, mfc::Direction direction, mfc::Configuration& configuration) {
  const std::set<std::string> triggers(mfc::kTriggerNames.begin(), mfc::kTriggerNames.end());
  for (const mfc::Register& entry : mfc::kRegisters) {
    if (entry.direction != direction || !entry.mappable()) {
      continue;
    }
    const auto name = reader.choice(entry.name, triggers);
    for (std::size_t code = 0; name && code < mfc::kTriggerCount; ++code) {
      if (mfc::kTriggerNames[code] == *name) {
        configuration.set_mapping(entry.number, {true, static_cast<mfc::Trigger>(code)});
      }
    }
  }
  reader.finish();
}

/// Where a block's three buffers end, behind them.
std::uint32_t buffers_end(const mfc::MemoryMap::Block& block) {
  return block.start + kBuffers * block.length;
}

/// "0x1000 to 0x10ff".
std::string extent_text(std::uint32_t begin, std::uint32_t end) {
  return hexadecimal(begin, 4) + " to " + hexadecimal(end - 1, 4);
}

void check_extent(Reader& reader, unsigned number, const mfc::Configuration& configuration) {
  const mfc::MemoryMap map(configuration);
  const mfc::MemoryMap::Block& block = map.block(number);
  const std::uint32_t end = buffers_end(block);
  if (end > mfc::MemoryMap::kMemoryEnd) {
    reader.refuse("start", "the block takes three buffers of " + std::to_string(block.length) +
                               " bytes and would end at " + hexadecimal(end - 1, 4) +
                               ", behind the process data RAM (0x4fff)");
  }
  if (number == 0) {
    return;
  }
  const mfc::MemoryMap::Block& other = map.block(0);
  const std::uint32_t other_end = buffers_end(other);
  if (block.length != 0 && other.length != 0 && other.start < end && block.start < other_end) {
    reader.refuse("start", "the block, " + extent_text(block.start, end) +
                               " with its three buffers, overlaps the one of [write], " +
                               extent_text(other.start, other_end));
  }
}

/// Block 0, which the master writes, or 1, which it reads.
template <unsigned Number>
void read_block(const KeyWords& key, Reader& reader, MfcConfigurationFile& file) {
  auto table = reader.section(key);
  if (!table) {
    return;
  }
  const auto start =
      table->integer("start", mfc::MemoryMap::kMemoryBegin, mfc::MemoryMap::kMemoryEnd - 1);
  if (!start) {
    table->refuse("start",
                  "\"start\" is missing: the block's address in process data RAM, 0x1000 "
                  "to 0x4FFF");
    return;
  }
  mfc::Configuration& configuration = file.configuration;
  configuration.set_block_start(Number, static_cast<std::uint16_t>(*start));
  if (auto registers = table->section("registers")) {
    read_registers(*registers, Number == 0 ? mfc::Direction::write : mfc::Direction::read,
                   configuration);
  }
  check_extent(*table, Number, configuration);
  table->finish();
}

constexpr std::array kConfigurationRows{
    settings::section<kIdentityKeys, &MfcConfigurationFile::identity>("identity", ""),
    settings::custom<MfcConfigurationFile, read_pins>("pins", ""),
    settings::custom<MfcConfigurationFile, read_high_voltage>("high_voltage", ""),
    settings::custom<MfcConfigurationFile, read_regulators>("regulators", ""),
    settings::custom<MfcConfigurationFile, read_block<0>>("write", ""),
    settings::custom<MfcConfigurationFile, read_block<1>>("read", "")};
constexpr settings::Section<MfcConfigurationFile> kConfigurationKeys{kConfigurationRows};

}  // namespace

void read_mfc_configuration(Reader& root, MfcConfigurationFile& content) {
  settings::read_section(kConfigurationKeys, root, content);
}

}  // namespace stator::devices::tmc8461
