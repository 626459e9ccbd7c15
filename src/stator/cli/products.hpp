#pragma once

#include <memory>
#include <string>

#include "stator/product/catalogue/product.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::cli {

/// The product `type`. Throws std::runtime_error naming the products there are.
[[nodiscard]] std::shared_ptr<const product::Product> find_product(const std::string& type);

/// Builds the product `type` as it leaves its box; its events go nowhere. Throws Failure naming the
/// products there are.
[[nodiscard]] std::unique_ptr<product::Device> build_product(const std::string& type);

/// Null if the product runs no programs in TMCL.
[[nodiscard]] const tmcl::ModuleDescription* find_tmcl_module(const std::string& type);

/// The module of that name for which programs in TMCL are written. Throws Failure naming those
/// there are.
[[nodiscard]] const tmcl::ModuleDescription& tmcl_module(const std::string& type);

}  // namespace stator::cli
