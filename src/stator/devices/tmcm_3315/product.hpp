#pragma once

#include <memory>

#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// The TMCM-3315 as a product; its setups hold a Tmcm3315Configuration.
[[nodiscard]] std::shared_ptr<const product::Product> tmcm_3315_product();

}  // namespace stator::devices
