#include "stator/devices/tmcc160/keys.hpp"

#include <array>
#include <cstdint>
#include <string>

#include "stator/canopen/node_id.hpp"
#include "stator/devices/tmcc160/objects.hpp"
#include "stator/plant/keys/servo_axis_keys.hpp"
#include "stator/product/shell/quirk_keys.hpp"
#include "stator/product/shell/rate_keys.hpp"

namespace stator::devices {

namespace tmcc160 {

namespace {

using namespace base::literals;

void read_friendly(const settings::KeyWords& key, settings::Reader& reader, Options& options) {
  if (reader.boolean(key).value_or(false)) {
    options = Options::friendly();
  }
}

/// A duration that the drive keeps in milliseconds; what is less is cut off.
template <std::uint16_t Options::*Time>
void read_milliseconds(const settings::KeyWords& key, settings::Reader& reader, Options& options) {
  if (const auto time = reader.duration(key, 0_ms, 60_s)) {
    options.*Time = static_cast<std::uint16_t>(*time / 1_ms);
  }
}

constexpr std::array kOptionRows{
    settings::custom<Options, read_friendly>(
        "friendly", "Switches on what generic CANopen masters expect beyond its document"),
    settings::boolean<&Options::eds>("eds", "The EDS can be read at 1021h"),
    settings::boolean<&Options::lss>("lss", "Layer setting services"),
    settings::boolean<&Options::event_driven_values>("event_driven_values",
                                                     "TPDOs are sent when their values change"),
    settings::boolean<&Options::stores_communication_objects>(
        "stores_communication_objects", "1010h stores communication objects too"),
    settings::boolean<&Options::maps_as_maker_eds>(
        "maps_as_maker_eds",
        "2702h, 6062h, 6063h and 60FDh can be mapped into TPDOs, as in the maker's data sheets"),
    settings::boolean<&Options::undocumented_emergencies>("undocumented_emergencies",
                                                          "Emergencies its document does not name"),
    settings::boolean<&Options::cia_402_device_type>("cia_402_device_type", "1000h says CiA 402"),
    settings::boolean<&Options::zero_gains>("zero_gains", "Gains are 0 as delivered"),
    settings::boolean<&Options::home_offset_is_position>(
        "home_offset_is_position",
        "At home the position becomes the home offset 607Ch instead of its negative"),
    settings::boolean<&Options::switches_fixed_while_on>(
        "switches_fixed_while_on", "Polarity of switches cannot change while the drive is on"),
    settings::custom<Options, read_milliseconds<&Options::status_event_timer>>(
        "status_event_timer", "Event timer of the TPDO with the statusword"),
    settings::custom<Options, read_milliseconds<&Options::heartbeat_time>>(
        "heartbeat", "Producer heartbeat time 1017h as delivered"),
};
constexpr settings::Section<Options> kOptionKeys{kOptionRows};

void read_bit_rate(const settings::KeyWords& key, settings::Reader& reader,
                   Tmcc160Configuration& configuration) {
  if (const auto place = product::read_rate(key, reader, {20, 1000}, kBitRates, "the drive")) {
    configuration.bit_rate = static_cast<std::uint16_t>(kBitRates[*place]);
  }
}

/// Once the options are known: without LSS nothing could give the drive a node-ID.
std::string objection_to_node_id(const Tmcc160Configuration& configuration,
                                 const settings::Reader& /*reader*/) {
  const std::string none = std::to_string(canopen::kUnconfiguredNodeId);
  if (canopen::is_node_id(configuration.node_id)) {
    return {};
  }
  if (configuration.node_id != canopen::kUnconfiguredNodeId) {
    return "\"node_id\" is " + std::to_string(configuration.node_id) + "; a node-ID is " +
           std::to_string(canopen::kMinimumNodeId) + " to " +
           std::to_string(canopen::kMaximumNodeId) + ", and " + none +
           " stands for none, until LSS gives one";
  }
  return configuration.options.lss
             ? std::string()
             : "\"node_id\" is " + none +
                   ", a drive without a node-ID, and nothing could give it one; set \"lss\" or "
                   "\"friendly\" to true too";
}

constexpr std::array kDriveRows{
    settings::keys<product::kCanopenQuirkKeys, &Tmcc160Configuration::quirks>(),
    settings::whole<&Tmcc160Configuration::node_id>(
        "node_id", {canopen::kMinimumNodeId, canopen::kUnconfiguredNodeId},
        "As delivered, 1 to 127, or with lss 255 for none; parameters stored in the state "
        "directory have precedence"),
    settings::custom<Tmcc160Configuration, read_bit_rate>("bit_rate", "As delivered", "kbit/s"),
    settings::whole<&Tmcc160Configuration::serial_number>(
        "serial_number", {0, 0xFFFFFFFF}, "1018h:04 and last part of its LSS address, with lss"),
    settings::duration<&Tmcc160Configuration::boot_time>("boot_time", {0_us, 60_s},
                                                         "From power-on to the boot-up message"),
    settings::duration<&Tmcc160Configuration::sdo_timeout>("sdo_timeout", {1_ms, 60_s},
                                                           "Between two segments of an SDO"),
    settings::keys<kOptionKeys, &Tmcc160Configuration::options>(),
    settings::section<plant::kServoAxisKeys, &Tmcc160Configuration::axis>("axis",
                                                                          "Motor, load, sensors"),
};
constexpr std::array kDriveRules{
    settings::Rule<Tmcc160Configuration>{"node_id", objection_to_node_id}};

}  // namespace

}  // namespace tmcc160

constinit const settings::Section<Tmcc160Configuration> kTmcc160Keys{tmcc160::kDriveRows,
                                                                     tmcc160::kDriveRules};

}  // namespace stator::devices
