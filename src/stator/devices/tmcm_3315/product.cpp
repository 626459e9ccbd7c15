#include "stator/devices/tmcm_3315/product.hpp"

#include "stator/devices/tmcm_3315/controller.hpp"
#include "stator/devices/tmcm_3315/keys.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/product/device/axis_bench.hpp"

namespace stator::devices {

namespace {

/// Its first axis, commanded without a bus.
class BenchedAxis final : public product::AxisBench {
 public:
  BenchedAxis(const plant::StepperAxisParameters& axis, double full_scale_current)
      : module_(around(axis, full_scale_current)) {
    module_.axis(0).set_network_operational(true, base::SimTime());
  }

  [[nodiscard]] dictionary::Dictionary& dictionary() override { return module_.dictionary(); }
  void apply(base::SimTime now) override { module_.axis(0).apply(now); }
  void advance(base::SimTime now) override { module_.advance(now); }
  [[nodiscard]] base::SimDuration plant_step() const override { return Tmcm3315::kPlantStep; }
  [[nodiscard]] double microsteps_per_revolution() const override { return 51'200.0; }
  [[nodiscard]] const control::RampGenerator& ramp() override {
    return module_.axis(0).axis().motion().ramp();
  }
  [[nodiscard]] plant::StepperAxis& plant() override { return module_.axis(0).plant(); }

 private:
  static Tmcm3315Configuration around(const plant::StepperAxisParameters& axis,
                                      double full_scale_current) {
    Tmcm3315Configuration configuration;
    configuration.axes[0] = axis;
    configuration.full_scale_current = full_scale_current;
    return configuration;
  }

  Tmcm3315 module_;
};

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
  /// Microsteps of 1/256 full step.
  [[nodiscard]] std::optional<product::MotionUnits> motion_units() const override {
    return product::MotionUnits{.position = 51'200.0, .velocity = 51'200.0};
  }
  [[nodiscard]] std::span<const ethercat::ControllerPreset> controllers() const override {
    return {&tmcm_3315::kController, 1};
  }
  [[nodiscard]] std::unique_ptr<product::AxisBench> axis_bench(
      const plant::StepperAxisParameters& axis, double full_scale_current) const override {
    return std::make_unique<BenchedAxis>(axis, full_scale_current);
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
