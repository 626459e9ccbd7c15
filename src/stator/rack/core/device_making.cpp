#include "stator/rack/core/device_making.hpp"

#include <set>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/settings/words.hpp"

namespace stator::rack {

namespace {

/// Makes the device of a setup and checks that it is a `Kind`, as devices on its product's network
/// have to be. Products of a program's own may declare one network and make devices of another.
template <typename Kind>
std::unique_ptr<Kind> make(const product::Setup& setup, const base::EventReporter& reporter) {
  std::unique_ptr<product::Device> device = setup.make(reporter);
  auto* const kind = dynamic_cast<Kind*>(device.get());
  if (kind == nullptr) {
    throw std::logic_error(
        fmt::format("the product \"{}\" makes devices that do not belong on its network",
                    setup.product().identity().type));
  }
  static_cast<void>(device.release());
  return std::unique_ptr<Kind>(kind);
}

}  // namespace

std::shared_ptr<const product::Product> require_product(std::string_view type,
                                                        const product::Catalogue& catalogue) {
  if (auto product = catalogue.find(type); product != nullptr) {
    return product;
  }
  std::set<std::string> types;
  for (const auto& product : catalogue.products()) {
    types.insert(product->identity().type);
  }
  const std::string guess = settings::closest_match(type, types);
  throw std::runtime_error(fmt::format(
      "there is no product \"{}\"{}; the products are: {}", type,
      guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess), fmt::join(types, ", ")));
}

RackConfiguration single_device_rack(std::string_view type, const product::Catalogue& catalogue) {
  const auto product = require_product(type, catalogue);
  const DeviceConfiguration device{.name = std::string(type), .setup = product->defaults()};
  RackConfiguration configuration;
  if (product->identity().network == NetworkKind::segment) {
    configuration.segments.emplace_back().devices.push_back(device);
  } else {
    configuration.buses.emplace_back().devices.push_back(device);
  }
  return configuration;
}

std::unique_ptr<product::EtherCatDevice> make_ethercat_device(const product::Setup& setup,
                                                              const base::EventReporter& reporter) {
  if (const auto& identity = setup.product().identity(); identity.network != NetworkKind::segment) {
    throw std::runtime_error(
        fmt::format("a {} is no EtherCAT device; it belongs on a [[bus]]", identity.name()));
  }
  return make<product::EtherCatDevice>(setup, reporter);
}

std::unique_ptr<product::CanDevice> make_can_device(const product::Setup& setup,
                                                    const base::EventReporter& reporter) {
  if (const auto& identity = setup.product().identity(); identity.network != NetworkKind::bus) {
    throw std::runtime_error(
        fmt::format("a {} is no CAN device; it belongs into a [[segment]]", identity.name()));
  }
  return make<product::CanDevice>(setup, reporter);
}

}  // namespace stator::rack
