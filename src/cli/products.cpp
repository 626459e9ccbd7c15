#include "cli/products.hpp"

#include "rack/product_catalogue.hpp"

namespace stator::cli {

std::unique_ptr<devices::Device> build_product(const std::string& type) {
  return rack::make_device(rack::require_product(type).default_configuration(), {});
}

}  // namespace stator::cli
