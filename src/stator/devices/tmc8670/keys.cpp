#include "stator/devices/tmc8670/keys.hpp"

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "stator/base/byte_order.hpp"
#include "stator/base/event.hpp"
#include "stator/devices/tmc8670/internal/controllers.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/plant/keys/pwm_axis_keys.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/phy_keys.hpp"
#include "stator/product/shell/quirk_keys.hpp"

namespace stator::devices {

namespace tmc8670 {

namespace {

std::optional<unsigned> hexadecimal(std::string_view digits, unsigned maximum) {
  unsigned value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size() ||
      value > maximum) {
    return std::nullopt;
  }
  return value;
}

/// What the dictionary says against the value; empty if it takes it.
std::string problem_of(dictionary::Dictionary& dictionary, const ObjectValue& object) {
  dictionary::Entry* entry = dictionary.find(object.index, object.subindex);
  if (entry == nullptr) {
    return "the device has no such object; see \"stator describe tmc8670\"";
  }
  if (dictionary::is_string(entry->type())) {
    return "it is a text";
  }
  std::array<std::byte, 8> bytes{};
  base::store_le(bytes, 0, object.bits);
  const std::size_t size = entry->size();
  const auto written = dictionary.write(*entry, std::span(bytes).first(size), {});
  if (!written) {
    const dictionary::Refusal& refusal = written.error();
    return refusal.rule != nullptr ? base::to_sentence({{}, refusal.rule, 0, refusal.arguments})
                                   : std::string(dictionary::to_text(refusal.code));
  }
  // What does not fit the type was cut off.
  if (entry->value() != object.bits) {
    return std::to_string(static_cast<std::int64_t>(object.bits)) + " does not fit " +
           std::string(dictionary::to_text(entry->type()));
  }
  return {};
}

void refuse_name(settings::Reader& reader, const std::string& name) {
  static_cast<void>(reader.integer({name, "What it is as delivered"},
                                   std::numeric_limits<std::int64_t>::min(),
                                   std::numeric_limits<std::int64_t>::max()));
  reader.refuse(name, '"' + name +
                          "\" names no object; write index and subindex in hexadecimal, e.g. "
                          "\"6065\" or \"2030:03\"");
}

std::string unsuitable(const std::string& name, std::int64_t value, const std::string& reason) {
  return '"' + name + "\" cannot be " + std::to_string(value) + ": " + reason;
}

void read_objects(const settings::KeyWords& key, settings::Reader& reader,
                  Tmc8670Configuration& configuration) {
  auto table = reader.section(key);
  if (!table) {
    return;
  }
  dictionary::Dictionary dictionary;
  add_objects(dictionary);
  for (const std::string& name : table->names()) {
    std::optional<ObjectValue> object = object_named(name);
    if (!object) {
      refuse_name(*table, name);
      continue;
    }
    const auto value = table->integer(name, std::numeric_limits<std::int32_t>::min(),
                                      std::numeric_limits<std::uint32_t>::max());
    if (!value) {
      continue;
    }
    object->bits = static_cast<std::uint64_t>(*value);
    if (const std::string reason = problem_of(dictionary, *object); !reason.empty()) {
      table->refuse(name, unsuitable(name, *value, reason));
      continue;
    }
    configuration.objects.push_back(*object);
  }
  table->finish();
}

/// Seconds of a PWM period as the chip is delivered: 2001h:01 counts from 0, in steps of 10 ns.
double pwm_period(const std::vector<ObjectValue>& objects) {
  constexpr std::uint16_t kPwm = 0x2001;
  constexpr std::uint8_t kMaximumCount = 1;
  dictionary::Dictionary dictionary;
  add_objects(dictionary);
  std::uint64_t maximum = dictionary.find(kPwm, kMaximumCount)->value();
  for (const ObjectValue& object : objects) {
    if (object.index == kPwm && object.subindex == kMaximumCount) {
      maximum = object.bits;
    }
  }
  return 1e-8 * static_cast<double>(maximum + 1);
}

/// The chip makes the PWM, by which a dead time is judged.
void read_axis(const settings::KeyWords& key, settings::Reader& reader,
               Tmc8670Configuration& configuration) {
  if (auto axis = reader.section(key)) {
    configuration.axis.inverter.pwm_frequency = 1.0 / pwm_period(configuration.objects);
    settings::read_section(plant::kPwmAxisKeys, *axis, configuration.axis);
  }
}

std::array<std::string_view, kControllers.size()> controller_presets() {
  std::array<std::string_view, kControllers.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    names[i] = kControllers[i].name;
  }
  return names;
}

constexpr std::array kAutomatic{settings::Word{"automatic", 0}};

constexpr std::array kChipRows = settings::rows(
    std::array{
        settings::keys<product::kCoeQuirkKeys, &Tmc8670Configuration::quirks>(),
        settings::whole<&Tmc8670Configuration::coe, &product::CoeOptions::station_alias>(
            "alias", {0, 0xFFFF},
            "Configured station alias (SII word 4); an EEPROM file in the state directory has "
            "precedence"),
        settings::whole<&Tmc8670Configuration::serial_number>("serial_number", {0, 0xFFFFFFFF},
                                                              "1018h:04 and SII"),
        settings::one_of<controller_presets, &Tmc8670Configuration::controller>(
            "controller", "Which reading of its slave controller"),
        settings::whole<&Tmc8670Configuration::clock_deviation_ppb>(
            "clock_deviation_ppb", {-1'000'000, 1'000'000, "ppb"}, "Error of its oscillator"),
        settings::wholes_or_word<&Tmc8670Configuration::tx_shift>(
            "tx_shift", {0, 3}, kAutomatic,
            "Straps by which ports 0 and 1 send later, steps of 10 ns; automatic: the chip finds "
            "them itself"),
    },
    product::phy_rows<Tmc8670Configuration>(),
    std::array{
        settings::boolean<&Tmc8670Configuration::host_controls_time>(
            "host_controls_time", "0910h to 0935h are the host's to write, not the master's"),
        settings::keys<product::kCoeKeys, &Tmc8670Configuration::coe>(),
        settings::keys<product::kFirmwareDownloadKeys, &Tmc8670Configuration::coe>(),
        settings::custom<Tmc8670Configuration, read_objects>(
            "objects",
            "Other defaults of objects; keys are index and subindex in hexadecimal, \"2030:03\""),
        settings::custom<Tmc8670Configuration, read_axis>("axis", "What is around the chip"),
    });

}  // namespace

std::optional<ObjectValue> object_named(std::string_view key) {
  const std::size_t colon = key.find(':');
  std::string_view index = key.substr(0, colon);
  if (index.ends_with('h')) {
    index.remove_suffix(1);
  }
  const auto number = hexadecimal(index, 0xFFFF);
  const auto subindex = colon == std::string_view::npos ? std::optional<unsigned>(0)
                                                        : hexadecimal(key.substr(colon + 1), 0xFF);
  if (!number || !subindex) {
    return std::nullopt;
  }
  return ObjectValue{static_cast<std::uint16_t>(*number), static_cast<std::uint8_t>(*subindex)};
}

}  // namespace tmc8670

constinit const settings::Section<Tmc8670Configuration> kTmc8670Keys{tmc8670::kChipRows};

}  // namespace stator::devices
