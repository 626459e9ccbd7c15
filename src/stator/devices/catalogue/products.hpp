#pragma once

#include "stator/product/catalogue/catalogue.hpp"

namespace stator::devices {

/// Adds the products of this project, in the order people should see them: the one place that names
/// all of them.
void add_products(product::Catalogue& catalogue);

/// A catalogue of them, made once.
[[nodiscard]] const product::Catalogue& products();

}  // namespace stator::devices
