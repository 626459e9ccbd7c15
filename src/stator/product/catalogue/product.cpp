#include "stator/product/catalogue/product.hpp"

#include "stator/ethercat/controller/controller_preset.hpp"
#include "stator/product/catalogue/io_configuration.hpp"
#include "stator/product/device/axis_bench.hpp"

namespace stator::product {

namespace {

class OwnProduct final : public Product {
 public:
  OwnProduct(Identity identity, DeviceMaker maker)
      : identity_(std::move(identity)), maker_(std::move(maker)) {}

  [[nodiscard]] const Identity& identity() const override { return identity_; }
  [[nodiscard]] Setup defaults() const override { return {shared_from_this(), Nothing{}}; }
  [[nodiscard]] std::unique_ptr<Device> make(const Setup& /*setup*/,
                                             base::EventReporter reporter) const override {
    return maker_(reporter);
  }

 private:
  struct Nothing {};

  Identity identity_;
  DeviceMaker maker_;
};

}  // namespace

std::span<const ethercat::ControllerPreset> Product::controllers() const {
  return {};
}

std::unique_ptr<IoConfiguration> Product::io_configuration() const {
  return nullptr;
}

std::unique_ptr<AxisBench> Product::axis_bench(const plant::StepperAxisParameters& /*axis*/,
                                               double /*full_scale_current*/) const {
  return nullptr;
}

std::shared_ptr<const Product> make_product(Identity identity, DeviceMaker maker) {
  return std::make_shared<OwnProduct>(std::move(identity), std::move(maker));
}

}  // namespace stator::product
