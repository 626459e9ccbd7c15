#include "stator/rack/file/bus_section.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "stator/link/can/can_link_address.hpp"
#include "stator/rack/file/device_section.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::rack {

namespace {

/// "unlimited" or kbit/s.
void read_bit_rate(const settings::KeyWords& key, settings::Reader& reader, BusConfiguration& bus) {
  constexpr std::int64_t kSlowest = 5;
  constexpr std::int64_t kFastest = 1000;
  constexpr const char* kUnlimited = "unlimited";
  reader.note_default(key, std::to_string(*bus.bit_rate / 1000));
  const auto read_rate = [&] {
    if (const auto rate = reader.integer(key, kSlowest, kFastest)) {
      bus.bit_rate = static_cast<std::uint32_t>(*rate * 1000);
    }
  };
  reader.either(reader.is_text(key.name), read_rate, [&] {
    if (reader.describes()) {
      reader.choice(key, {kUnlimited});
    } else if (const auto word = reader.text(key); word != kUnlimited) {
      reader.refuse(key.name, fmt::format(R"("{}" is "{}"; it must be "{}" or kbit/s, {} .. {})",
                                          key.name, *word, kUnlimited, kSlowest, kFastest));
    }
    bus.bit_rate.reset();
  });
}

/// Only one can listen there; networks of the system take any number.
bool is_server(const link::CanLinkAddress& address) {
  using enum link::CanLinkKind;
  return address.kind == slcan ||
         ((address.kind == slcan_tcp || address.kind == socketcand) && address.port != 0);
}

void read_ports(const settings::KeyWords& key, settings::Reader& reader, BusConfiguration& bus) {
  reader.texts(key, bus.ports);
  for (const std::string& port : bus.ports) {
    if (const auto address = link::parse_can_link_address(port); !address) {
      reader.refuse(key.name, address.error().text);
    } else if (is_server(*address)) {
      reader.claim(key.name, to_text(*address));
    }
  }
}

constexpr std::array kBusRows{
    settings::custom<BusConfiguration, read_bit_rate>(
        "bit_rate", "Each frame takes the time its bits take; unlimited: frames take no time",
        "kbit/s"),
    settings::boolean<&BusConfiguration::ports_acknowledge>(
        "ports_acknowledge", "false: only devices acknowledge frames"),
    settings::custom<BusConfiguration, read_ports>(
        "ports",
        "Where programs connect: slcan:PATH, slcan-tcp:PORT, socketcand:PORT, "
        "socketcan:INTERFACE, udp-multicast:, can-exec:NAME"),
    settings::output<&BusConfiguration::log>("log",
                                             "candump log of everything on the wire, with the "
                                             "machine's time; in lockstep with simulated "
                                             "time"),
    settings::output<&BusConfiguration::capture>("capture", "The same as a pcap file"),
    settings::whole<&BusConfiguration::cpu>("cpu", kProcessors,
                                            "Processor the bus's thread is tied to"),
};
constexpr settings::Section<BusConfiguration> kBusKeys{kBusRows};

BusConfiguration read_bus(TableReader& section, std::size_t number, DeviceReading& reading) {
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
  settings::read_keys(kBusKeys, section, bus);
  for (TableReader& device : section.sections({"device", "The CAN devices on it"})) {
    device.attempt([&] {
      read_device(device, reading, NetworkKind::bus, [&](DeviceConfiguration configuration) {
        bus.devices.push_back(std::move(configuration));
        device.finish();
      });
    });
  }
  if (bus.devices.empty() && section.sections("device").empty()) {
    section.refuse("device", "a bus needs at least one [[bus.device]]");
  }
  section.finish();
  return bus;
}

}  // namespace

void read_buses(TableReader& root, DeviceReading& reading, std::vector<BusConfiguration>& buses) {
  for (TableReader& section : root.sections({"bus", "CAN devices on one wire"})) {
    section.attempt([&] { buses.push_back(read_bus(section, buses.size(), reading)); });
  }
}

}  // namespace stator::rack
