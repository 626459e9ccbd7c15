// Devices whose objects and behaviour are written in Python: products for a rack's catalogue.
#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>

#include <nanobind/nanobind.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/device/device.hpp"

namespace stator::python {

/// The exception that a device's function in Python ended with, until somebody takes it. Functions
/// are called by whoever lets time pass, which may be a thread that nobody waits for.
class DeviceFailure {
 public:
  /// Keeps the exception that is being handled, if none is kept.
  void keep();
  /// Throws the exception that is kept, if one is, which then is no longer.
  void raise();

 private:
  std::atomic<bool> kept_{false};
  std::mutex mutex_;
  std::exception_ptr exception_;
};

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
