#pragma once

#include <memory>

#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// The junction as a product; its setups hold a JunctionConfiguration.
[[nodiscard]] std::shared_ptr<const product::Product> junction_product();

}  // namespace stator::devices
