#include "stator/rack/file/bus_section.hpp"

#include <cstdint>
#include <optional>

#include <fmt/format.h>

#include "stator/link/can/can_link_address.hpp"
#include "stator/rack/file/device_section.hpp"

namespace stator::rack {

namespace {

/// "unlimited" or kbit/s.
std::optional<std::uint32_t> read_bit_rate(TomlSection& section,
                                           std::optional<std::uint32_t> otherwise) {
  constexpr std::int64_t kSlowest = 5;
  constexpr std::int64_t kFastest = 1000;
  const TomlKey key("bit_rate",
                    "Each frame takes the time its bits take; unlimited: frames take no time",
                    "kbit/s");
  section.note_default(key, std::to_string(*otherwise / 1000));
  if (section.is_text("bit_rate")) {
    section.choice(key, {"unlimited"});
    return std::nullopt;
  }
  const auto rate = section.integer(key, kSlowest, kFastest);
  return rate ? static_cast<std::uint32_t>(*rate * 1000) : otherwise;
}

/// Only one can listen there; networks of the system take any number.
bool is_server(const link::CanLinkAddress& address) {
  using enum link::CanLinkKind;
  return address.kind == slcan ||
         ((address.kind == slcan_tcp || address.kind == socketcand) && address.port != 0);
}

BusConfiguration read_bus(TomlSection& section, std::size_t number, DeviceReading& reading) {
  BusConfiguration bus;
  bus.name = section
                 .text({"name",
                        "Unique in the rack; prefix of its own signals and log lines; can0, can1, "
                        "… by default"})
                 .value_or(fmt::format("can{}", number));
  if (!reading.names.insert(bus.name).second) {
    section.refuse("name",
                   fmt::format("the name \"{}\" is given twice; give each bus and device its "
                               "own \"name\"",
                               bus.name));
  }
  bus.bit_rate = read_bit_rate(section, bus.bit_rate);
  section.boolean({"ports_acknowledge", "false: only devices acknowledge frames"},
                  bus.ports_acknowledge);
  section.texts({"ports",
                 "Where programs connect: slcan:PATH, slcan-tcp:PORT, socketcand:PORT, "
                 "socketcan:INTERFACE, udp-multicast:, can-exec:NAME"},
                bus.ports);
  for (const std::string& port : bus.ports) {
    if (const auto address = link::parse_can_link_address(port); !address) {
      section.refuse("ports", address.error().text);
    } else if (is_server(*address)) {
      section.claim("ports", to_text(*address));
    }
  }
  bus.log = section.output(
      {"log",
       "candump log of everything on the wire, with the machine's time; in lockstep with simulated "
       "time"});
  bus.capture = section.output({"capture", "The same as a pcap file"});
  if (const auto cpu = section.integer({"cpu", "Processor the bus's thread is tied to"}, 0, 1023)) {
    bus.cpu = static_cast<unsigned>(*cpu);
  }
  for (TomlSection& device : section.sections({"device", "The CAN devices on it"})) {
    device.attempt([&] {
      bus.devices.push_back(read_device(device, reading, NetworkKind::bus));
      device.finish();
    });
  }
  if (bus.devices.empty() && section.sections("device").empty()) {
    section.refuse("device", "a bus needs at least one [[bus.device]]");
  }
  section.finish();
  return bus;
}

}  // namespace

void read_buses(TomlSection& root, DeviceReading& reading, std::vector<BusConfiguration>& buses) {
  for (TomlSection& section : root.sections({"bus", "CAN devices on one wire"})) {
    section.attempt([&] { buses.push_back(read_bus(section, buses.size(), reading)); });
  }
}

}  // namespace stator::rack
