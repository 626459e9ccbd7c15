#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/product/catalogue/product.hpp"

namespace stator::product {

/// Makes a product of a type that names where its description is, e.g. "esi:terminal.xml". The same
/// type has to give the same product each time. Throws std::runtime_error, saying why and what to
/// do, where there is none.
using ProductResolver = std::function<std::shared_ptr<const Product>(std::string_view type)>;

/// The products that readers of rack files, benches and commands know. A value: a program that has
/// products of its own copies one and adds them.
class Catalogue {
 public:
  /// Behind those that are there, which is the order people see. Throws std::logic_error if there
  /// is one of that type.
  void add(std::shared_ptr<const Product> product);

  /// Types that begin with `prefix` and a colon are made by `resolver`; the part behind the colon
  /// begins with the path of a file.
  void add_resolver(std::string prefix, ProductResolver resolver) {
    resolvers_.emplace_back(std::move(prefix), std::move(resolver));
  }

  /// The product of that type, or null. Throws what the resolver throws whose type it is.
  [[nodiscard]] std::shared_ptr<const Product> find(std::string_view type) const;
  /// Where the path of a file begins in `type`: behind the prefix of a resolver and its colon; 0:
  /// it is no resolver's.
  [[nodiscard]] std::size_t path_position(std::string_view type) const;
  /// All, in the order people see.
  [[nodiscard]] std::span<const std::shared_ptr<const Product>> products() const {
    return products_;
  }

 private:
  std::vector<std::shared_ptr<const Product>> products_;
  std::vector<std::pair<std::string, ProductResolver>> resolvers_;
};

}  // namespace stator::product
