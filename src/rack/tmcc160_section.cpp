#include "rack/tmcc160_section.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "devices/tmcc160/objects.hpp"
#include "rack/servo_axis_section.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;
using devices::tmcc160::kBitRates;
using devices::tmcc160::Options;

/// Keys of options that are on or off.
struct Switch {
  const char* key;
  bool Options::*option;
};
constexpr std::array kSwitches{
    Switch{"eds", &Options::eds},
    Switch{"lss", &Options::lss},
    Switch{"event_driven_values", &Options::event_driven_values},
    Switch{"stores_communication_objects", &Options::stores_communication_objects},
    Switch{"undocumented_emergencies", &Options::undocumented_emergencies},
    Switch{"cia_402_device_type", &Options::cia_402_device_type},
    Switch{"zero_gains", &Options::zero_gains},
    Switch{"home_offset_is_position", &Options::home_offset_is_position},
    Switch{"switches_fixed_while_on", &Options::switches_fixed_while_on},
};

std::uint16_t milliseconds(base::SimDuration duration) {
  return static_cast<std::uint16_t>(duration.nanoseconds() / 1'000'000);
}

void read_options(TomlSection& section, Options& options) {
  if (section.boolean("friendly").value_or(false)) {
    options = Options::friendly();
  }
  for (const Switch& entry : kSwitches) {
    bool& option = options.*entry.option;
    option = section.boolean(entry.key).value_or(option);
  }
  if (const auto time = section.duration("status_event_timer", 0_ms, 60_s)) {
    options.status_event_timer = milliseconds(*time);
  }
  if (const auto time = section.duration("heartbeat", 0_ms, 60_s)) {
    options.heartbeat_time = milliseconds(*time);
  }
}

}  // namespace

void read_tmcc160(TomlSection& section, devices::Tmcc160Configuration& configuration) {
  if (const auto node_id = section.integer("node_id", 1, 127)) {
    configuration.node_id = static_cast<std::uint8_t>(*node_id);
  }
  if (const auto bit_rate = section.integer("bit_rate", 20, 1000)) {
    if (std::ranges::find(kBitRates, *bit_rate) == kBitRates.end()) {
      section.refuse("bit_rate", fmt::format("\"bit_rate\" is {} kbit/s; the drive knows {}",
                                             *bit_rate, fmt::join(kBitRates, ", ")));
    } else {
      configuration.bit_rate = static_cast<std::uint16_t>(*bit_rate);
    }
  }
  if (const auto number = section.integer("serial_number", 0, 0xFFFFFFFF)) {
    configuration.serial_number = static_cast<std::uint32_t>(*number);
  }
  configuration.boot_time =
      section.duration("boot_time", 0_us, 60_s).value_or(configuration.boot_time);
  configuration.sdo_timeout =
      section.duration("sdo_timeout", 1_ms, 60_s).value_or(configuration.sdo_timeout);
  read_options(section, configuration.options);
  if (auto axis = section.section("axis")) {
    read_servo_axis(*axis, configuration.axis);
  }
}

}  // namespace stator::rack
