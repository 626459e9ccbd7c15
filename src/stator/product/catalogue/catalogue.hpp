#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/product/catalogue/product.hpp"

namespace stator::product {

/// The products that readers of rack files, benches and commands know. A value: a program that has
/// products of its own copies one and adds them.
class Catalogue {
 public:
  /// Makes a product from what follows the scheme in a type, e.g. from "drive.xml" in
  /// "esi:drive.xml"; null if there is none.
  using Resolver = std::function<std::shared_ptr<const Product>(std::string_view rest)>;

  /// Behind those that are there, which is the order people see. Throws std::logic_error if there
  /// is one of that type.
  void add(std::shared_ptr<const Product> product);
  /// Types that begin with `scheme` and a colon are made by `resolver`. Throws std::logic_error if
  /// there is one.
  void add_scheme(std::string scheme, Resolver resolver);

  /// The product of that type, or null.
  [[nodiscard]] std::shared_ptr<const Product> find(std::string_view type) const;
  [[nodiscard]] std::span<const std::shared_ptr<const Product>> products() const {
    return products_;
  }

 private:
  std::vector<std::shared_ptr<const Product>> products_;
  std::vector<std::pair<std::string, Resolver>> schemes_;
};

}  // namespace stator::product
