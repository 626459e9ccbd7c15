#pragma once

#include <cstddef>
#include <cstdint>

namespace stator::rack {

/// The end of an order to a DeviceStorage.
struct StorageCompletion {
  std::size_t memory = 0;     ///< number of the memory within the storage
  std::uint32_t version = 0;  ///< of the order; those before it end with it
  bool kept = false;
};

}  // namespace stator::rack
