#include "cli/products.hpp"

#include <fmt/format.h>

#include "cli/failure.hpp"
#include "devices/tmcm_142/parameters.hpp"
#include "rack/product_catalogue.hpp"

namespace stator::cli {

std::unique_ptr<devices::Device> build_product(const std::string& type) {
  return rack::make_device(rack::require_product(type).default_configuration(), {});
}

const tmcl::ModuleDescription& tmcl_module(const std::string& type) {
  const tmcl::ModuleDescription& only = devices::tmcm_142_description();
  if (type != only.product) {
    throw Failure(fmt::format("\"{}\" runs no programs in TMCL; the device that does is {}", type,
                              only.product));
  }
  return only;
}

}  // namespace stator::cli
