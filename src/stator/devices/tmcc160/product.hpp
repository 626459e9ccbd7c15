#pragma once

#include <memory>

#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// The TMCC160 as a product; its setups hold a Tmcc160Configuration.
[[nodiscard]] std::shared_ptr<const product::Product> tmcc160_product();

}  // namespace stator::devices
