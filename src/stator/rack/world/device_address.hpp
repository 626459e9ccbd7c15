#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace stator::rack {

/// What devices are wired with.
enum class NetworkKind : std::uint8_t {
  segment,  ///< EtherCAT
  bus,      ///< CAN
};

/// A device by its place in the rack.
struct DeviceAddress {
  std::size_t network = 0;  ///< number of its segment or of its bus
  std::size_t device = 0;
  NetworkKind kind = NetworkKind::segment;

  friend auto operator<=>(const DeviceAddress&, const DeviceAddress&) = default;
};

}  // namespace stator::rack
