#include "rack/product_catalogue.hpp"

#include <array>
#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "rack/text.hpp"

namespace stator::rack {

namespace {

constexpr std::array<Product, 1> kProducts{{
    {"tmcm-3315", "three-axis stepper module, CiA 402, TMCM-3315", "EtherCAT (CoE, FoE)", 2,
     [] { return ProductConfiguration(devices::Tmcm3315Configuration{}); }},
}};

std::unique_ptr<devices::EtherCatDevice> make(const devices::Tmcm3315Configuration& configuration,
                                              const base::EventReporter& reporter) {
  return std::make_unique<devices::Tmcm3315>(configuration, reporter);
}

}  // namespace

std::span<const Product> products() {
  return kProducts;
}

const Product* find_product(std::string_view type) {
  for (const Product& product : kProducts) {
    if (product.type == type) {
      return &product;
    }
  }
  return nullptr;
}

const Product& require_product(std::string_view type) {
  if (const Product* product = find_product(type); product != nullptr) {
    return *product;
  }
  std::set<std::string> types;
  for (const Product& product : kProducts) {
    types.emplace(product.type);
  }
  const std::string guess = closest_match(type, types);
  throw std::runtime_error(fmt::format(
      "there is no product \"{}\"{}; the products are: {}", type,
      guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess), fmt::join(types, ", ")));
}

RackConfiguration single_device_rack(std::string_view type) {
  RackConfiguration configuration;
  configuration.segments.emplace_back().devices.push_back(
      {std::string(type), require_product(type).default_configuration()});
  return configuration;
}

std::unique_ptr<devices::EtherCatDevice> make_device(const ProductConfiguration& configuration,
                                                     const base::EventReporter& reporter) {
  return std::visit([&reporter](const auto& product) { return make(product, reporter); },
                    configuration);
}

}  // namespace stator::rack
