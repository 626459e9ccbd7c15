#include "stator/product/catalogue/catalogue.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stator::product {

namespace {

bool begins_with(std::string_view type, std::string_view prefix) {
  return type.size() > prefix.size() && type.starts_with(prefix) && type[prefix.size()] == ':';
}

}  // namespace

void Catalogue::add(std::shared_ptr<const Product> product) {
  if (find(product->identity().type) != nullptr) {
    throw std::logic_error("there are two products \"" + product->identity().type + "\"");
  }
  products_.push_back(std::move(product));
}

std::shared_ptr<const Product> Catalogue::find(std::string_view type) const {
  const auto found = std::ranges::find_if(
      products_, [type](const auto& product) { return product->identity().type == type; });
  if (found != products_.end()) {
    return *found;
  }
  for (const auto& [prefix, resolver] : resolvers_) {
    if (begins_with(type, prefix)) {
      return resolver(type);
    }
  }
  return nullptr;
}

std::size_t Catalogue::path_position(std::string_view type) const {
  for (const auto& [prefix, resolver] : resolvers_) {
    if (begins_with(type, prefix)) {
      return prefix.size() + 1;
    }
  }
  return 0;
}

}  // namespace stator::product
