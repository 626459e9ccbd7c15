#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/device.hpp"
#include "stator/product/device/ethercat_device.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::rack {

/// One product Stator can run: what `stator devices` lists and a rack file's `type` names.
struct Product {
  std::string_view type;     ///< "tmcm-3315"
  std::string_view summary;  ///< what it is, in half a line
  std::string_view reached_over;
  NetworkKind network;
  unsigned ports;  ///< for EtherCAT cables, numbered from 0; see ports_of()
  std::span<const std::string_view> serial_interfaces;  ///< keys of a device in a rack file
  ProductConfiguration (*default_configuration)();
};

/// All products, in the order people should see them.
[[nodiscard]] std::span<const Product> products();

/// The product with that type, or null.
[[nodiscard]] const Product* find_product(std::string_view type);

/// The product with that type. Throws std::runtime_error naming the closest and all products.
[[nodiscard]] const Product& require_product(std::string_view type);

/// The product a configuration belongs to, or null for a device of one's own.
[[nodiscard]] const Product* product_of(const ProductConfiguration& configuration);
/// Its order code in capitals, for people and files, e.g. "TMCM-3315".
[[nodiscard]] std::string product_name(const ProductConfiguration& configuration);
[[nodiscard]] NetworkKind network_of(const ProductConfiguration& configuration);
/// How many ports it has for EtherCAT cables.
[[nodiscard]] unsigned ports_of(const ProductConfiguration& configuration);

/// A rack with one segment or bus and one device of that type as it leaves its box; a bus has
/// no ports. Throws as above.
[[nodiscard]] RackConfiguration single_device_rack(std::string_view type);

/// Builds the device; it reports its events through `reporter`.
[[nodiscard]] std::unique_ptr<product::Device> make_device(
    const ProductConfiguration& configuration, const base::EventReporter& reporter);
/// The same for a device on EtherCAT or on CAN. Throw std::runtime_error for one that is not.
[[nodiscard]] std::unique_ptr<product::EtherCatDevice> make_ethercat_device(
    const ProductConfiguration& configuration, const base::EventReporter& reporter);
[[nodiscard]] std::unique_ptr<product::CanDevice> make_can_device(
    const ProductConfiguration& configuration, const base::EventReporter& reporter);

}  // namespace stator::rack
