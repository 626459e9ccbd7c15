#pragma once

#include <memory>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::rack {

/// The product with that type. Throws std::runtime_error naming the closest and all products.
[[nodiscard]] std::shared_ptr<const product::Product> require_product(
    std::string_view type, const product::Catalogue& catalogue);

/// A rack with one segment or bus and one device of that type as it leaves its box; a bus has
/// no ports. Throws as above.
[[nodiscard]] RackConfiguration single_device_rack(std::string_view type,
                                                   const product::Catalogue& catalogue);

/// Builds a device on EtherCAT or on CAN, which reports its events through `reporter`. Throw
/// std::runtime_error for one that is not, std::logic_error if its product makes no such device.
[[nodiscard]] std::unique_ptr<product::EtherCatDevice> make_ethercat_device(
    const product::Setup& setup, const base::EventReporter& reporter);
[[nodiscard]] std::unique_ptr<product::CanDevice> make_can_device(
    const product::Setup& setup, const base::EventReporter& reporter);

}  // namespace stator::rack
