#pragma once

#include <memory>

#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// The TMC8670 as a product; its setups hold a Tmc8670Configuration.
[[nodiscard]] std::shared_ptr<const product::Product> tmc8670_product();

}  // namespace stator::devices
