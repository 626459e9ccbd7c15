// Devices whose objects and behaviour are written in Python: products for a rack's catalogue.
#pragma once

#include <memory>

#include <nanobind/nanobind.h>

#include "device_behaviour.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/device/device.hpp"

namespace stator::python {

/// Adds a product for each of `factories`, functions of Python that make an instance of
/// stator.OwnDevice each time they are called and have its class's attributes. Devices report
/// failures to `failure`. Throws std::runtime_error for a class that lacks or contradicts
/// something.
void add_own_products(product::Catalogue& catalogue, nanobind::handle factories,
                      const std::shared_ptr<DeviceFailure>& failure);

/// The instance behind a device; None: its product is none of Python's. The rack is held, the
/// interpreter as well.
[[nodiscard]] nanobind::object instance_of(const product::Device& device);

}  // namespace stator::python
