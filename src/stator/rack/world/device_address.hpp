#pragma once

#include <compare>
#include <cstddef>

#include "stator/product/catalogue/identity.hpp"

namespace stator::rack {

using product::NetworkKind;

/// A device by its place in the rack.
struct DeviceAddress {
  std::size_t network = 0;  ///< number of its segment or of its bus
  std::size_t device = 0;
  NetworkKind kind = NetworkKind::segment;

  friend auto operator<=>(const DeviceAddress&, const DeviceAddress&) = default;
};

}  // namespace stator::rack
