// A TMC8461's configuration written as a file for people.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "stator/devices/tmc8461/hexadecimal.hpp"
#include "stator/devices/tmc8461/mfc_configuration_keys.hpp"
#include "stator/mfc/pins/crossbar.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/registers/register_map.hpp"
#include "stator/mfc/units/regulators.hpp"

namespace stator::devices::tmc8461 {

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

/// A key and its value as one line.
std::string line_of(std::string_view key, const std::string& value) {
  return std::string(key) + " = " + value + '\n';
}
std::string switch_line(std::string_view key, bool on) {
  return line_of(key, on ? "true" : "false");
}

/// To "A, B".
void add_to_list(std::string& list, const std::string& element) {
  list += (list.empty() ? "" : ", ") + element;
}

std::string identity_text(const BoardIdentity& identity) {
  return "[identity]\n" + line_of("vendor_id", hexadecimal(identity.vendor_id)) +
         line_of("vendor", quoted(identity.vendor_name)) +
         line_of("product_code", hexadecimal(identity.product_code)) +
         line_of("revision", hexadecimal(identity.revision)) +
         line_of("serial_number", std::to_string(identity.serial_number)) +
         line_of("name", quoted(identity.name)) +
         line_of("order_code", quoted(identity.order_code)) +
         line_of("group", quoted(identity.group)) +
         line_of("station_alias", std::to_string(identity.station_alias)) +
         switch_line("device_emulation", identity.device_emulation) +
         switch_line("distributed_clocks", identity.distributed_clocks) +
         line_of("sync_pulse_length", std::to_string(identity.sync_pulse_length)) +
         line_of("eeprom_kbit", std::to_string(identity.sii_size_kbit));
}

std::string pins_text(const mfc::Configuration& configuration) {
  std::string text = "\n[pins]\n";
  for (std::size_t line = 0; line < mfc::kLines; ++line) {
    const std::uint8_t code = configuration.signal(line);
    if (code != 0 && code < mfc::kSignals) {
      text += line_of(mfc::kLineNames[line],
                      quoted(mfc::describe(static_cast<mfc::Signal>(code)).name));
    }
  }
  return text;
}

/// The high-voltage pins that have a bit, from bit `shift` on.
std::string pin_list(std::uint32_t settings, unsigned shift) {
  std::string list;
  for (std::size_t pin = 0; pin < mfc::kHighVoltageLines; ++pin) {
    if ((settings >> (shift + pin) & 1U) != 0) {
      add_to_list(list, quoted(mfc::kLineNames[mfc::kFirstHighVoltage + pin]));
    }
  }
  return '[' + list + ']';
}

std::string pair_list(std::uint32_t settings) {
  std::string list;
  for (std::size_t i = 0; i < mfc::kDifferentialPairs.size(); ++i) {
    if ((settings >> (24 + i) & 1U) != 0) {
      const mfc::DifferentialPair& pair = mfc::kDifferentialPairs[i];
      add_to_list(list, '"' + std::string(mfc::kLineNames[pair.positive]) + '-' +
                            std::string(mfc::kLineNames[pair.negative]) + '"');
    }
  }
  return '[' + list + ']';
}

std::string high_voltage_text(std::uint32_t settings) {
  if (settings == 0) {
    return {};
  }
  return "\n[high_voltage]\n" + line_of("slow_slope", pin_list(settings, 0)) +
         line_of("weak_high", pin_list(settings, 8)) + line_of("weak_low", pin_list(settings, 16)) +
         line_of("differential", pair_list(settings));
}

std::string regulator_text(std::string_view name, const mfc::RegulatorSettings& settings,
                           bool adjustable) {
  std::string text =
      "\n[regulators." + std::string(name) + "]\n" +
      line_of("saw_frequency_khz", std::to_string(settings.saw_kilohertz)) +
      line_of("amplification_percent",
              std::to_string(mfc::regulator_percent(settings.amplification_code))) +
      line_of("damping_percent", std::to_string(mfc::regulator_percent(settings.damping_code))) +
      switch_line("over_current_protection", settings.over_current_protection);
  if (adjustable) {
    text += switch_line("enabled", settings.enabled);
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
      registers += line_of(entry.name,
                           quoted(mfc::kTriggerNames[static_cast<std::size_t>(mapping.trigger)]));
    }
  }
  if (registers.empty()) {
    return {};
  }
  const std::string name = block == 0 ? "write" : "read";
  return "\n[" + name + "]\n" + line_of("start", hexadecimal(configuration.block_start(block))) +
         "\n[" + name + ".registers]\n" + registers;
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

}  // namespace stator::devices::tmc8461
