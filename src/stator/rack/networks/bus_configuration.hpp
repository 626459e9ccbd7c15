#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/rack/world/device_configuration.hpp"

namespace stator::rack {

/// CAN devices on one wire, and the ports through which masters reach it.
struct BusConfiguration {
  std::string name = "can0";  ///< unique within the rack; empty if there is no wire
  /// False: no wire. Its devices are reached over serial lines only, and nobody sees a bus.
  bool wire = true;
  /// Bit/s, kept to in simulated time; nothing: unlimited, frames take no time.
  std::optional<std::uint32_t> bit_rate{1'000'000};
  bool ports_acknowledge = true;   ///< see can::BusSettings
  std::vector<std::string> ports;  ///< e.g. "slcan:/tmp/stator-can0"; see link::kCanLinkForms
  std::string log;                 ///< candump log of everything on the wire; empty = none
  std::string capture;             ///< the same as pcap file
  std::optional<unsigned> cpu;     ///< processor the bus's thread is tied to
  std::vector<DeviceConfiguration> devices;
};

/// A bus for devices that are reached over serial lines only.
[[nodiscard]] inline BusConfiguration bus_without_wire() {
  BusConfiguration bus;
  bus.name.clear();
  bus.wire = false;
  bus.bit_rate = std::nullopt;
  return bus;
}

}  // namespace stator::rack
