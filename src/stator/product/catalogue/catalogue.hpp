#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "stator/product/catalogue/product.hpp"

namespace stator::product {

/// The products that readers of rack files, benches and commands know. A value: a program that has
/// products of its own copies one and adds them.
class Catalogue {
 public:
  /// Behind those that are there, which is the order people see. Throws std::logic_error if there
  /// is one of that type.
  void add(std::shared_ptr<const Product> product);

  /// The product of that type, or null.
  [[nodiscard]] std::shared_ptr<const Product> find(std::string_view type) const;
  /// All, in the order people see.
  [[nodiscard]] std::span<const std::shared_ptr<const Product>> products() const {
    return products_;
  }

 private:
  std::vector<std::shared_ptr<const Product>> products_;
};

}  // namespace stator::product
