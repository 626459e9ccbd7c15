#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/tmcl/module/module_description.hpp"

namespace stator::cli {

/// The products of this program, as run() got them.
[[nodiscard]] const product::Catalogue& catalogue();
/// Sets what catalogue() returns; `catalogue` must live as long as the program.
void set_catalogue(const product::Catalogue& catalogue);

/// The product `type`. Throws std::runtime_error naming the products there are.
[[nodiscard]] std::shared_ptr<const product::Product> find_product(const std::string& type);

/// The types of the products for which `is_so` holds, in the order of the catalogue.
[[nodiscard]] std::vector<std::string> types_of_products(
    const std::function<bool(const product::Product&)>& is_so);
/// The first of them, to be a default or an example; empty if there is none.
[[nodiscard]] std::string first_product(const std::function<bool(const product::Product&)>& is_so);

/// Builds the product `type` as it leaves its box; its events go nowhere. Throws Failure naming the
/// products there are.
[[nodiscard]] std::unique_ptr<product::Device> build_product(const std::string& type);

/// Null if the product runs no programs in TMCL.
[[nodiscard]] const tmcl::ModuleDescription* find_tmcl_module(const std::string& type);

/// The module that programs in TMCL are for if nobody says which.
[[nodiscard]] std::string usual_tmcl_module();

/// The module of that name for which programs in TMCL are written. Throws Failure naming those
/// there are.
[[nodiscard]] const tmcl::ModuleDescription& tmcl_module(const std::string& type);

}  // namespace stator::cli
