// A TMC8461's configuration written as a file for people.

#include <array>
#include <vector>

#include <fmt/format.h>

#include "stator/mfc/pins/crossbar.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/registers/register_map.hpp"
#include "stator/mfc/units/regulators.hpp"
#include "stator/rack/sections/mfc_configuration_file.hpp"

namespace stator::rack {

namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    result += c;
  }
  return result + '"';
}

std::string identity_text(const devices::tmc8461::BoardIdentity& identity) {
  return fmt::format(
      "[identity]\n"
      "vendor_id = {:#x}\n"
      "vendor = {}\n"
      "product_code = {:#x}\n"
      "revision = {:#x}\n"
      "serial_number = {}\n"
      "name = {}\n"
      "order_code = {}\n"
      "group = {}\n"
      "station_alias = {}\n"
      "device_emulation = {}\n"
      "distributed_clocks = {}\n"
      "sync_pulse_length = {}\n"
      "eeprom_kbit = {}\n",
      identity.vendor_id, quoted(identity.vendor_name), identity.product_code, identity.revision,
      identity.serial_number, quoted(identity.name), quoted(identity.order_code),
      quoted(identity.group), identity.station_alias, identity.device_emulation,
      identity.distributed_clocks, identity.sync_pulse_length, identity.sii_size_kbit);
}

std::string pins_text(const mfc::Configuration& configuration) {
  std::string text = "\n[pins]\n";
  for (std::size_t line = 0; line < mfc::kLines; ++line) {
    const std::uint8_t code = configuration.signal(line);
    if (code != 0 && code < mfc::kSignals) {
      text += fmt::format("{} = {}\n", mfc::kLineNames[line],
                          quoted(mfc::describe(static_cast<mfc::Signal>(code)).name));
    }
  }
  return text;
}

std::string high_voltage_text(std::uint32_t settings) {
  if (settings == 0) {
    return {};
  }
  const auto pins = [settings](unsigned shift) {
    std::vector<std::string> names;
    for (std::size_t pin = 0; pin < mfc::kHighVoltageLines; ++pin) {
      if ((settings >> (shift + pin) & 1U) != 0) {
        names.push_back(quoted(mfc::kLineNames[mfc::kFirstHighVoltage + pin]));
      }
    }
    return fmt::format("[{}]", fmt::join(names, ", "));
  };
  std::vector<std::string> pairs;
  for (std::size_t i = 0; i < mfc::kDifferentialPairs.size(); ++i) {
    if ((settings >> (24 + i) & 1U) != 0) {
      const mfc::DifferentialPair& pair = mfc::kDifferentialPairs[i];
      pairs.push_back(
          fmt::format("\"{}-{}\"", mfc::kLineNames[pair.positive], mfc::kLineNames[pair.negative]));
    }
  }
  return fmt::format(
      "\n[high_voltage]\nslow_slope = {}\nweak_high = {}\nweak_low = {}\ndifferential = [{}]\n",
      pins(0), pins(8), pins(16), fmt::join(pairs, ", "));
}

std::string regulator_text(std::string_view name, const mfc::RegulatorSettings& settings,
                           bool adjustable) {
  std::string text = fmt::format(
      "\n[regulators.{}]\n"
      "saw_frequency_khz = {}\n"
      "amplification_percent = {}\n"
      "damping_percent = {}\n"
      "over_current_protection = {}\n",
      name, settings.saw_kilohertz, mfc::regulator_percent(settings.amplification_code),
      mfc::regulator_percent(settings.damping_code), settings.over_current_protection);
  if (adjustable) {
    text += fmt::format("enabled = {}\n", settings.enabled);
  }
  return text;
}

std::string block_text(const mfc::Configuration& configuration, unsigned block) {
  const auto direction = block == 0 ? mfc::Direction::write : mfc::Direction::read;
  std::string registers;
  for (const mfc::Register& entry : mfc::kRegisters) {
    if (entry.direction != direction || !entry.mappable()) {
      continue;
    }
    const mfc::Mapping mapping = configuration.mapping(entry.number);
    if (mapping.enabled) {
      registers +=
          fmt::format("{} = {}\n", entry.name,
                      quoted(mfc::kTriggerNames[static_cast<std::size_t>(mapping.trigger)]));
    }
  }
  if (registers.empty()) {
    return {};
  }
  const std::string_view name = block == 0 ? "write" : "read";
  return fmt::format("\n[{}]\nstart = {:#x}\n\n[{}.registers]\n{}", name,
                     configuration.block_start(block), name, registers);
}

}  // namespace

std::string mfc_configuration_text(const MfcConfigurationFile& content) {
  std::string text = identity_text(content.identity) + pins_text(content.configuration) +
                     high_voltage_text(content.configuration.high_voltage());
  if (content.configuration.regulators() != 0) {
    mfc::Regulators regulators;
    regulators.configure({}, content.configuration.regulators());
    text += regulator_text("fixed", regulators.fixed(), false) +
            regulator_text("adjustable", regulators.adjustable(), true);
  }
  return text + block_text(content.configuration, 0) + block_text(content.configuration, 1);
}

}  // namespace stator::rack
