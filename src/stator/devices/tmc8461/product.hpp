#pragma once

#include <memory>

#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// The TMC8461 as a product; its setups hold a Tmc8461Configuration.
[[nodiscard]] std::shared_ptr<const product::Product> tmc8461_product();

}  // namespace stator::devices
