#pragma once

#include <span>

#include "stator/product/catalogue/fault_consequence.hpp"

namespace stator::devices {

/// What faults come to with the products of this project, by kind and product. That each is so is
/// shown in tests/rack/surroundings_<product>_test.cpp.
[[nodiscard]] std::span<const product::FaultConsequence> fault_consequences();

}  // namespace stator::devices
