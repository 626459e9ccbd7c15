#include "stator/cli/products.hpp"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/cli/failure.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"

namespace stator::cli {

namespace {

const product::Catalogue* products_of_program = nullptr;

bool runs_tmcl(const product::Product& product) {
  return product.tmcl_module() != nullptr;
}

}  // namespace

const product::Catalogue& catalogue() {
  return *products_of_program;
}

void set_catalogue(const product::Catalogue& catalogue) {
  products_of_program = &catalogue;
}

std::shared_ptr<const product::Product> find_product(const std::string& type) {
  return rack::require_product(type, catalogue());
}

std::vector<std::string> types_of_products(
    const std::function<bool(const product::Product&)>& is_so) {
  std::vector<std::string> types;
  for (const auto& product : catalogue().products()) {
    if (is_so(*product)) {
      types.push_back(product->identity().type);
    }
  }
  return types;
}

std::string first_product(const std::function<bool(const product::Product&)>& is_so) {
  const std::vector<std::string> types = types_of_products(is_so);
  return types.empty() ? std::string() : types.front();
}

std::unique_ptr<product::Device> build_product(const std::string& type) {
  return find_product(type)->defaults().make();
}

const tmcl::ModuleDescription* find_tmcl_module(const std::string& type) {
  const auto product = catalogue().find(type);
  return product != nullptr ? product->tmcl_module() : nullptr;
}

std::string usual_tmcl_module() {
  return first_product(runs_tmcl);
}

const tmcl::ModuleDescription& tmcl_module(const std::string& type) {
  const tmcl::ModuleDescription* module = find_tmcl_module(type);
  if (module == nullptr) {
    throw Failure(fmt::format("\"{}\" runs no programs in TMCL; the device that does is {}", type,
                              fmt::join(types_of_products(runs_tmcl), " or ")));
  }
  return *module;
}

}  // namespace stator::cli
