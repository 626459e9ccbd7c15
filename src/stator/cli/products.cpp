#include "stator/cli/products.hpp"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/cli/failure.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"

namespace stator::cli {

std::shared_ptr<const product::Product> find_product(const std::string& type) {
  return rack::require_product(type, devices::products());
}

std::unique_ptr<product::Device> build_product(const std::string& type) {
  return find_product(type)->defaults().make();
}

const tmcl::ModuleDescription* find_tmcl_module(const std::string& type) {
  const auto product = devices::products().find(type);
  return product != nullptr ? product->tmcl_module() : nullptr;
}

const tmcl::ModuleDescription& tmcl_module(const std::string& type) {
  const tmcl::ModuleDescription* module = find_tmcl_module(type);
  if (module == nullptr) {
    std::vector<std::string> modules;
    for (const auto& product : devices::products().products()) {
      if (product->tmcl_module() != nullptr) {
        modules.push_back(product->identity().type);
      }
    }
    throw Failure(fmt::format("\"{}\" runs no programs in TMCL; the device that does is {}", type,
                              fmt::join(modules, " or ")));
  }
  return *module;
}

}  // namespace stator::cli
