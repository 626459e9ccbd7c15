#include "stator/rack/sections/tmc8670_section.hpp"

#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/base/event.hpp"
#include "stator/devices/tmc8670/objects.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/rack/sections/coe_keys.hpp"
#include "stator/rack/sections/phy_keys.hpp"
#include "stator/rack/sections/pwm_axis_section.hpp"
#include "stator/rack/sections/quirks_section.hpp"

namespace stator::rack {

namespace {

using devices::tmc8670::ObjectValue;

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
std::string objection(const dictionary::Dictionary& dictionary, const ObjectValue& object) {
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
    return fmt::format("{} does not fit {}", static_cast<std::int64_t>(object.bits),
                       dictionary::to_text(entry->type()));
  }
  return {};
}

void read_objects(TomlSection section, std::vector<ObjectValue>& objects) {
  dictionary::Dictionary dictionary;
  devices::tmc8670::add_objects(dictionary);
  for (const std::string& key : section.names()) {
    std::optional<ObjectValue> object = object_named(key);
    if (!object) {
      static_cast<void>(section.integer({key, "What it is as delivered"},
                                        std::numeric_limits<std::int64_t>::min(),
                                        std::numeric_limits<std::int64_t>::max()));
      section.refuse(key, fmt::format("\"{}\" names no object; write index and subindex in "
                                      "hexadecimal, e.g. \"6065\" or \"2030:03\"",
                                      key));
      continue;
    }
    const auto value = section.integer(key, std::numeric_limits<std::int32_t>::min(),
                                       std::numeric_limits<std::uint32_t>::max());
    if (!value) {
      continue;
    }
    object->bits = static_cast<std::uint64_t>(*value);
    if (const std::string reason = objection(dictionary, *object); !reason.empty()) {
      section.refuse(key, fmt::format("\"{}\" cannot be {}: {}", key, *value, reason));
      continue;
    }
    objects.push_back(*object);
  }
  section.finish();
}

/// Seconds of a PWM period as the chip is delivered: 2001h:01 counts from 0, in steps of 10 ns.
double pwm_period(const std::vector<ObjectValue>& objects) {
  constexpr std::uint16_t kPwm = 0x2001;
  constexpr std::uint8_t kMaximumCount = 1;
  dictionary::Dictionary dictionary;
  devices::tmc8670::add_objects(dictionary);
  std::uint64_t maximum = dictionary.find(kPwm, kMaximumCount)->value();
  for (const ObjectValue& object : objects) {
    if (object.index == kPwm && object.subindex == kMaximumCount) {
      maximum = object.bits;
    }
  }
  return 1e-8 * static_cast<double>(maximum + 1);
}

/// How chip and PHYs are connected, and who steers the clock.
void read_straps(TomlSection& section, devices::Tmc8670Configuration& configuration) {
  if (section.is_text("tx_shift")) {
    static_cast<void>(section.choice({"tx_shift",
                                      "Straps by which ports 0 and 1 send later, steps of 10 ns; "
                                      "automatic: the chip finds them itself"},
                                     {"automatic"}));
    configuration.tx_shift.reset();
  } else if (const auto steps = of_ports(section, "tx_shift", 3)) {
    configuration.tx_shift = *steps;
  }
  read_phys(section, configuration);
  section.boolean(
      {"host_controls_time", "0910h to 0935h are the host's to write, not the master's"},
      configuration.host_controls_time);
}

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

void read_tmc8670(TomlSection& section, devices::Tmc8670Configuration& configuration) {
  read_quirks(section, QuirkKind::coe, configuration.quirks);
  section.integer({"alias",
                   "Configured station alias (SII word 4); an EEPROM file in the state directory "
                   "has precedence"},
                  0, 0xFFFF, configuration.coe.station_alias);
  section.integer({"serial_number", "1018h:04 and SII"}, 0, 0xFFFFFFFF,
                  configuration.serial_number);
  configuration.controller =
      section
          .choice({"controller", "Which reading of its slave controller"}, {"document", "silicon"})
          .value_or(configuration.controller);
  section.integer({"clock_deviation_ppb", "Error of its oscillator", "ppb"}, -1'000'000, 1'000'000,
                  configuration.clock_deviation_ppb);
  read_straps(section, configuration);
  read_coe_keys(section, configuration.coe);
  if (auto objects = section.section(
          {"objects",
           "Other defaults of objects; keys are index and subindex in hexadecimal, \"2030:03\""})) {
    read_objects(*objects, configuration.objects);
  }
  if (auto axis = section.section({"axis", "What is around the chip"})) {
    read_pwm_axis(*axis, pwm_period(configuration.objects), configuration.axis);
  }
}

}  // namespace stator::rack
