#include "stator/devices/tmcm_3315/product.hpp"

#include "stator/devices/tmcm_3315/controller.hpp"
#include "stator/devices/tmcm_3315/keys.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {

namespace {

class Tmcm3315Product final : public product::ProductOf<Tmcm3315Configuration, Tmcm3315> {
 public:
  using ProductOf::ProductOf;

  [[nodiscard]] const product::CoeOptions* coe(const product::Setup& setup) const override {
    return &of(setup).coe;
  }
  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return &of(setup).quirks;
  }
  [[nodiscard]] std::vector<product::AxisSetup> axes(product::Setup& setup) const override {
    std::vector<product::AxisSetup> axes;
    for (plant::StepperAxisParameters& axis : of(setup).axes) {
      axes.push_back({.stepper = &axis, .full_scale_current = of(setup).full_scale_current});
    }
    return axes;
  }
  [[nodiscard]] std::span<const ethercat::ControllerPreset> controllers() const override {
    return {&tmcm_3315::kController, 1};
  }
};

}  // namespace

std::shared_ptr<const product::Product> tmcm_3315_product() {
  return std::make_shared<Tmcm3315Product>(
      product::Identity{
          .type = "tmcm-3315",
          .summary = "three-axis stepper module, CiA 402, TMCM-3315",
          .reached_over = "EtherCAT (CoE, FoE)",
          .network = product::NetworkKind::segment,
          .ports = 2,
          .serial_interfaces = {{.name = std::string(Tmcm3315::kSerialInterfaces[0])}}},
      &kTmcm3315Keys);
}

}  // namespace stator::devices
