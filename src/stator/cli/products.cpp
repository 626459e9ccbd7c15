#include "stator/cli/products.hpp"

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/rack/core/product_catalogue.hpp"

namespace stator::cli {

std::unique_ptr<product::Device> build_product(const std::string& type) {
  return rack::make_device(rack::require_product(type).default_configuration(), {});
}

const tmcl::ModuleDescription* find_tmcl_module(const std::string& type) {
  const tmcl::ModuleDescription& only = devices::tmcm_142_description();
  return type == only.product ? &only : nullptr;
}

const tmcl::ModuleDescription& tmcl_module(const std::string& type) {
  const tmcl::ModuleDescription* module = find_tmcl_module(type);
  if (module == nullptr) {
    throw Failure(fmt::format("\"{}\" runs no programs in TMCL; the device that does is {}", type,
                              devices::tmcm_142_description().product));
  }
  return *module;
}

}  // namespace stator::cli
