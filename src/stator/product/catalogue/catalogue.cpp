#include "stator/product/catalogue/catalogue.hpp"

#include <algorithm>
#include <stdexcept>

namespace stator::product {

void Catalogue::add(std::shared_ptr<const Product> product) {
  if (find(product->identity().type) != nullptr) {
    throw std::logic_error("there are two products \"" + product->identity().type + "\"");
  }
  products_.push_back(std::move(product));
}

void Catalogue::add_scheme(std::string scheme, Resolver resolver) {
  if (std::ranges::find(schemes_, scheme, &std::pair<std::string, Resolver>::first) !=
      schemes_.end()) {
    throw std::logic_error("there are two schemes \"" + scheme + "\" of products");
  }
  schemes_.emplace_back(std::move(scheme), std::move(resolver));
}

std::shared_ptr<const Product> Catalogue::find(std::string_view type) const {
  for (const auto& product : products_) {
    if (product->identity().type == type) {
      return product;
    }
  }
  const std::size_t colon = type.find(':');
  if (colon == std::string_view::npos) {
    return nullptr;
  }
  for (const auto& [scheme, resolver] : schemes_) {
    if (scheme == type.substr(0, colon)) {
      return resolver(type.substr(colon + 1));
    }
  }
  return nullptr;
}

}  // namespace stator::product
