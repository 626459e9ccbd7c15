#pragma once

#include "stator/product/device/device.hpp"

namespace stator::tests {

/// A test may touch its device behind the rack's back.
template <typename Device>
Device& own(const product::Device& device) {
  return const_cast<Device&>(dynamic_cast<const Device&>(device));
}

}  // namespace stator::tests
