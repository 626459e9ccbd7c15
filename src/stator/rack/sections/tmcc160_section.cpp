#include "stator/rack/sections/tmcc160_section.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/canopen/node_id.hpp"
#include "stator/devices/tmcc160/objects.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/sections/quirks_section.hpp"
#include "stator/rack/sections/servo_axis_section.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;
using devices::tmcc160::kBitRates;
using devices::tmcc160::Options;

/// Keys of options that are on or off.
struct Switch {
  const char* key;
  const char* summary;
  bool Options::*option;
};
constexpr std::array kSwitches{
    Switch{"eds", "The EDS can be read at 1021h", &Options::eds},
    Switch{"lss", "Layer setting services", &Options::lss},
    Switch{"event_driven_values", "TPDOs are sent when their values change",
           &Options::event_driven_values},
    Switch{"stores_communication_objects", "1010h stores communication objects too",
           &Options::stores_communication_objects},
    Switch{"maps_as_maker_eds",
           "2702h, 6062h, 6063h and 60FDh can be mapped into TPDOs, as in the maker's data sheets",
           &Options::maps_as_maker_eds},
    Switch{"undocumented_emergencies", "Emergencies its document does not name",
           &Options::undocumented_emergencies},
    Switch{"cia_402_device_type", "1000h says CiA 402", &Options::cia_402_device_type},
    Switch{"zero_gains", "Gains are 0 as delivered", &Options::zero_gains},
    Switch{"home_offset_is_position",
           "At home the position becomes the home offset 607Ch instead of its negative",
           &Options::home_offset_is_position},
    Switch{"switches_fixed_while_on", "Polarity of switches cannot change while the drive is on",
           &Options::switches_fixed_while_on},
};

std::uint16_t milliseconds(base::SimDuration duration) {
  return static_cast<std::uint16_t>(duration.nanoseconds() / 1'000'000);
}

void read_options(TomlSection& section, Options& options) {
  if (section
          .boolean(
              {"friendly", "Switches on what generic CANopen masters expect beyond its document"})
          .value_or(false)) {
    options = Options::friendly();
  }
  for (const Switch& entry : kSwitches) {
    section.boolean({entry.key, entry.summary}, options.*entry.option);
  }
  if (const auto time = section.duration(
          {"status_event_timer", "Event timer of the TPDO with the statusword"}, 0_ms, 60_s)) {
    options.status_event_timer = milliseconds(*time);
  }
  if (const auto time = section.duration(
          {"heartbeat", "Producer heartbeat time 1017h as delivered"}, 0_ms, 60_s)) {
    options.heartbeat_time = milliseconds(*time);
  }
}

/// Once the options are known: without LSS nothing could give the drive a node-ID.
void check_node_id(TomlSection& section, const devices::Tmcc160Configuration& configuration) {
  if (canopen::is_node_id(configuration.node_id)) {
    return;
  }
  if (configuration.node_id != canopen::kUnconfiguredNodeId) {
    section.refuse("node_id", fmt::format("\"node_id\" is {}; a node-ID is {} to {}, and {} stands "
                                          "for none, until LSS gives one",
                                          configuration.node_id, canopen::kMinimumNodeId,
                                          canopen::kMaximumNodeId, canopen::kUnconfiguredNodeId));
  } else if (!configuration.options.lss) {
    section.refuse("node_id",
                   fmt::format("\"node_id\" is {}, a drive without a node-ID, and nothing could "
                               "give it one; set \"lss\" or \"friendly\" to true too",
                               canopen::kUnconfiguredNodeId));
  }
}

}  // namespace

void read_tmcc160(TomlSection& section, devices::Tmcc160Configuration& configuration) {
  read_quirks(section, QuirkKind::canopen, configuration.quirks);
  section.integer({"node_id",
                   "As delivered, 1 to 127, or with lss 255 for none; parameters stored in the "
                   "state directory have precedence"},
                  canopen::kMinimumNodeId, canopen::kUnconfiguredNodeId, configuration.node_id);
  if (const auto bit_rate = section.integer({"bit_rate", "As delivered", "kbit/s"}, 20, 1000)) {
    if (std::ranges::find(kBitRates, *bit_rate) == kBitRates.end()) {
      section.refuse("bit_rate", fmt::format("\"bit_rate\" is {} kbit/s; the drive knows {}",
                                             *bit_rate, fmt::join(kBitRates, ", ")));
    } else {
      configuration.bit_rate = static_cast<std::uint16_t>(*bit_rate);
    }
  }
  section.integer({"serial_number", "1018h:04 and last part of its LSS address, with lss"}, 0,
                  0xFFFFFFFF, configuration.serial_number);
  section.duration({"boot_time", "From power-on to the boot-up message"}, 0_us, 60_s,
                   configuration.boot_time);
  section.duration({"sdo_timeout", "Between two segments of an SDO"}, 1_ms, 60_s,
                   configuration.sdo_timeout);
  read_options(section, configuration.options);
  check_node_id(section, configuration);
  if (auto axis = section.section({"axis", "Motor, load, sensors"})) {
    read_servo_axis(*axis, configuration.axis);
  }
}

}  // namespace stator::rack
