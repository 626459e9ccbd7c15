#include "stator/product/catalogue/catalogue.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stator::product {

void Catalogue::add(std::shared_ptr<const Product> product) {
  if (find(product->identity().type) != nullptr) {
    throw std::logic_error("there are two products \"" + product->identity().type + "\"");
  }
  products_.push_back(std::move(product));
}

std::shared_ptr<const Product> Catalogue::find(std::string_view type) const {
  const auto found = std::ranges::find_if(
      products_, [type](const auto& product) { return product->identity().type == type; });
  return found != products_.end() ? *found : nullptr;
}

}  // namespace stator::product
