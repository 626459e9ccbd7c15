#include "stator/devices/junction/product.hpp"

#include "stator/devices/junction/controller.hpp"
#include "stator/devices/junction/junction.hpp"
#include "stator/devices/junction/keys.hpp"

namespace stator::devices {

namespace {

class JunctionProduct final : public product::ProductOf<JunctionConfiguration, Junction> {
 public:
  using ProductOf::ProductOf;

  [[nodiscard]] unsigned ports(const product::Setup& setup) const override {
    return of(setup).ports;
  }
  [[nodiscard]] std::span<const ethercat::ControllerPreset> controllers() const override {
    return {&kJunctionController, 1};
  }
};

}  // namespace

std::shared_ptr<const product::Product> junction_product() {
  return std::make_shared<JunctionProduct>(
      product::Identity{.type = "junction",
                        .summary = "coupler with three or four ports, for trees; nobody's product",
                        .reached_over = "EtherCAT",
                        .network = product::NetworkKind::segment,
                        .ports = JunctionConfiguration{}.ports,
                        .own_firmware = false},
      &kJunctionKeys);
}

}  // namespace stator::devices
