#pragma once

#include <memory>

#include "stator/product/catalogue/product.hpp"

namespace stator::devices {

/// The TMCM-142 as a product; its setups hold a Tmcm142Configuration.
[[nodiscard]] std::shared_ptr<const product::Product> tmcm_142_product();

}  // namespace stator::devices
