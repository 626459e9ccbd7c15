#include "stator/rack/core/product_catalogue.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include "stator/rack/world/text.hpp"

namespace stator::rack {

namespace {

constexpr std::array<Product, 6> kProducts{{
    {"tmcm-3315", "three-axis stepper module, CiA 402, TMCM-3315", "EtherCAT (CoE, FoE)",
     NetworkKind::segment, 2, devices::Tmcm3315::kSerialInterfaces,
     [] { return ProductConfiguration(devices::Tmcm3315Configuration{}); }},
    {"tmc8670", "servo drive in a chip, field-oriented control, CiA 402, TMC8670",
     "EtherCAT (CoE, FoE)", NetworkKind::segment, 2, devices::Tmc8670::kSerialInterfaces,
     [] { return ProductConfiguration(devices::Tmc8670Configuration{}); }},
    {"tmcc160", "servo drive for a three-phase motor, CiA 402, TMCC160", "CAN (CANopen)",
     NetworkKind::bus, 0, devices::Tmcc160::kSerialInterfaces,
     [] { return ProductConfiguration(devices::Tmcc160Configuration{}); }},
    {"tmcm-142", "one-axis stepper module with programs, TMCL, TMCM-142",
     "RS-232, RS-485, RS-422, USB, CAN (TMCL)", NetworkKind::bus, 0,
     devices::Tmcm142::kSerialInterfaces,
     [] { return ProductConfiguration(devices::Tmcm142Configuration{}); }},
    {"tmc8461",
     "slave controller chip with multi-function I/O, TMC8461",
     "EtherCAT; SPI (socket)",
     NetworkKind::segment,
     2,
     {},
     [] { return ProductConfiguration(devices::Tmc8461Configuration{}); }},
    {"junction",
     "coupler with three or four ports, for trees; nobody's product",
     "EtherCAT",
     NetworkKind::segment,
     devices::JunctionConfiguration{}.ports,
     {},
     [] { return ProductConfiguration(devices::JunctionConfiguration{}); }},
}};

std::unique_ptr<product::EtherCatDevice> make(const devices::Tmcm3315Configuration& configuration,
                                              const base::EventReporter& reporter) {
  return std::make_unique<devices::Tmcm3315>(configuration, reporter);
}

std::unique_ptr<product::EtherCatDevice> make(const devices::Tmc8670Configuration& configuration,
                                              const base::EventReporter& reporter) {
  return std::make_unique<devices::Tmc8670>(configuration, reporter);
}

std::unique_ptr<product::EtherCatDevice> make(const devices::Tmc8461Configuration& configuration,
                                              const base::EventReporter& reporter) {
  return std::make_unique<devices::Tmc8461>(configuration, reporter);
}

std::unique_ptr<product::EtherCatDevice> make(const devices::JunctionConfiguration& configuration,
                                              const base::EventReporter& reporter) {
  return std::make_unique<devices::Junction>(configuration, reporter);
}

std::unique_ptr<product::CanDevice> make(const devices::Tmcc160Configuration& configuration,
                                         const base::EventReporter& reporter) {
  return std::make_unique<devices::Tmcc160>(configuration, reporter);
}

std::unique_ptr<product::CanDevice> make(const devices::Tmcm142Configuration& configuration,
                                         const base::EventReporter& reporter) {
  return std::make_unique<devices::Tmcm142>(configuration, reporter);
}

std::unique_ptr<product::CanDevice> make(const OwnCanDevice& own,
                                         const base::EventReporter& reporter) {
  return own.make(reporter);
}

/// The device as the `Kind` of device it is asked for, or null if it is none.
template <typename Kind>
std::unique_ptr<Kind> make_kind(const ProductConfiguration& configuration,
                                const base::EventReporter& reporter) {
  return std::visit(
      [&reporter](const auto& product) -> std::unique_ptr<Kind> {
        if constexpr (std::is_convertible_v<decltype(make(product, reporter)),
                                            std::unique_ptr<Kind>>) {
          return make(product, reporter);
        } else {
          return nullptr;
        }
      },
      configuration);
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

const Product* product_of(const ProductConfiguration& configuration) {
  const auto found = std::ranges::find_if(kProducts, [&configuration](const Product& product) {
    return product.default_configuration().index() == configuration.index();
  });
  return found != kProducts.end() ? &*found : nullptr;
}

std::string product_name(const ProductConfiguration& configuration) {
  const Product* product = product_of(configuration);
  std::string name(product != nullptr ? product->type : "own device");
  std::ranges::transform(name, name.begin(), [](char letter) {
    return letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
  });
  return name;
}

NetworkKind network_of(const ProductConfiguration& configuration) {
  const Product* product = product_of(configuration);
  return product != nullptr ? product->network : NetworkKind::bus;
}

unsigned ports_of(const ProductConfiguration& configuration) {
  if (const auto* junction = std::get_if<devices::JunctionConfiguration>(&configuration)) {
    return junction->ports;
  }
  const Product* product = product_of(configuration);
  return product != nullptr ? product->ports : 0;
}

RackConfiguration single_device_rack(std::string_view type) {
  const Product& product = require_product(type);
  const DeviceConfiguration device{std::string(type), product.default_configuration()};
  RackConfiguration configuration;
  if (product.network == NetworkKind::segment) {
    configuration.segments.emplace_back().devices.push_back(device);
  } else {
    configuration.buses.emplace_back().devices.push_back(device);
  }
  return configuration;
}

std::unique_ptr<product::Device> make_device(const ProductConfiguration& configuration,
                                             const base::EventReporter& reporter) {
  return make_kind<product::Device>(configuration, reporter);
}

std::unique_ptr<product::EtherCatDevice> make_ethercat_device(
    const ProductConfiguration& configuration, const base::EventReporter& reporter) {
  auto device = make_kind<product::EtherCatDevice>(configuration, reporter);
  if (device == nullptr) {
    throw std::runtime_error(fmt::format("a {} is no EtherCAT device; it belongs on a [[bus]]",
                                         product_name(configuration)));
  }
  return device;
}

std::unique_ptr<product::CanDevice> make_can_device(const ProductConfiguration& configuration,
                                                    const base::EventReporter& reporter) {
  auto device = make_kind<product::CanDevice>(configuration, reporter);
  if (device == nullptr) {
    throw std::runtime_error(fmt::format("a {} is no CAN device; it belongs into a [[segment]]",
                                         product_name(configuration)));
  }
  return device;
}

}  // namespace stator::rack
