#pragma once

#include <string_view>

#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/controller/controller_preset.hpp"

namespace stator::ethercat::testing {

/// The slave controller of a product, in its default reading if none is named; null: there is none.
inline const ControllerPreset* find_controller(std::string_view product,
                                               std::string_view preset = {}) {
  const auto found = devices::products().find(product);
  return found ? find_preset(found->controllers(), preset) : nullptr;
}

inline const SlaveControllerConfiguration& controller_of(std::string_view product,
                                                         std::string_view preset = {}) {
  return find_controller(product, preset)->configuration;
}

}  // namespace stator::ethercat::testing
