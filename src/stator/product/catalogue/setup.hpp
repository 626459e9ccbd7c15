#pragma once

#include <any>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/product/catalogue/parts.hpp"

namespace stator::dictionary {
struct Quirks;
}

namespace stator::product {

class Device;
class Product;

/// One device to be built: a product and the product's own configuration, copied together.
class Setup {
 public:
  /// Of no product; nothing may be asked of it.
  Setup() = default;
  template <typename Configuration>
  Setup(std::shared_ptr<const Product> product, Configuration configuration)
      : product_(std::move(product)), configuration_(std::move(configuration)) {}

  [[nodiscard]] const Product& product() const { return *product_; }

  /// The product's own configuration. For the product itself, and for those who chose it; throws
  /// std::logic_error if it is of another type.
  template <typename Configuration>
  [[nodiscard]] Configuration& as() {
    return const_cast<Configuration&>(std::as_const(*this).template as<Configuration>());
  }
  template <typename Configuration>
  [[nodiscard]] const Configuration& as() const {
    const auto* configuration = find<Configuration>();
    if (configuration == nullptr) {
      throw std::logic_error("the device is configured as another product");
    }
    return *configuration;
  }
  /// The same, or null if it is of another type.
  template <typename Configuration>
  [[nodiscard]] const Configuration* find() const {
    return std::any_cast<Configuration>(&configuration_);
  }

  /// Builds the device, which reports its events through `reporter`.
  [[nodiscard]] std::unique_ptr<Device> make(base::EventReporter reporter = {}) const;

  // What the product finds in its configuration, see Product: null if it has nothing like it.
  [[nodiscard]] const CoeOptions* coe() const;
  [[nodiscard]] CoeOptions* coe() { return writable(std::as_const(*this).coe()); }
  [[nodiscard]] const dictionary::Quirks* quirks() const;
  [[nodiscard]] const std::uint8_t* node_id() const;
  [[nodiscard]] std::uint8_t* node_id() { return writable(std::as_const(*this).node_id()); }
  [[nodiscard]] const TmclAddress* tmcl_address() const;
  [[nodiscard]] TmclAddress* tmcl_address() {
    return writable(std::as_const(*this).tmcl_address());
  }
  /// What is around each of its axes.
  [[nodiscard]] std::vector<AxisSetup> axes();

 private:
  /// The configuration belongs to this object, which is not constant.
  template <typename Part>
  static Part* writable(const Part* part) {
    return const_cast<Part*>(part);
  }

  std::shared_ptr<const Product> product_;
  std::any configuration_;
};

}  // namespace stator::product
