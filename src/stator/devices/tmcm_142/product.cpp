#include "stator/devices/tmcm_142/product.hpp"

#include "stator/devices/tmcm_142/keys.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"

namespace stator::devices {

namespace {

/// The switches on the add-on board leave the interface on.
bool has_interface(const Tmcm142Configuration& module, std::string_view interface) {
  return !module.dip_switches.interface || *module.dip_switches.interface == interface;
}

class Tmcm142Product final : public product::ProductOf<Tmcm142Configuration, Tmcm142> {
 public:
  using ProductOf::ProductOf;

  [[nodiscard]] const product::TmclAddress* tmcl_address(
      const product::Setup& setup) const override {
    return &of(setup).tmcl;
  }
  [[nodiscard]] std::vector<product::AxisSetup> axes(product::Setup& setup) const override {
    return {{.stepper = &of(setup).axis}};
  }
  /// Microsteps of 1/256 full step.
  [[nodiscard]] std::optional<product::MotionUnits> motion_units() const override {
    return product::MotionUnits{.position = 51'200.0, .velocity = 51'200.0};
  }
  [[nodiscard]] std::vector<product::SerialInterface> serial_interfaces(
      const product::Setup& setup) const override {
    std::vector<product::SerialInterface> interfaces = identity().serial_interfaces;
    for (product::SerialInterface& interface : interfaces) {
      interface.baud_rate = tmcm_142::kBaudRates.at(of(setup).baud_rate);
    }
    return interfaces;
  }
  [[nodiscard]] std::optional<unsigned> tmcl_identifier(
      const product::Setup& setup) const override {
    const Tmcm142Configuration& module = of(setup);
    return has_interface(module, "can")
               ? std::optional<unsigned>(module.tmcl.can + module.dip_switches.address)
               : std::nullopt;
  }
  [[nodiscard]] std::optional<unsigned> tmcl_address_on(const product::Setup& setup,
                                                        std::string_view interface) const override {
    const Tmcm142Configuration& module = of(setup);
    if (!has_interface(module, interface)) {
      return std::nullopt;
    }
    const unsigned added = interface == "rs422" ? module.dip_switches.address : 0;
    return (module.tmcl.serial + added) & 0xFFU;
  }
  [[nodiscard]] const tmcl::ModuleDescription* tmcl_module() const override {
    return &tmcm_142_description();
  }
};

}  // namespace

std::shared_ptr<const product::Product> tmcm_142_product() {
  product::Identity identity{.type = "tmcm-142",
                             .summary = "one-axis stepper module with programs, TMCL, TMCM-142",
                             .reached_over = "RS-232, RS-485, RS-422, USB, CAN (TMCL)",
                             .network = product::NetworkKind::bus};
  for (const std::string_view interface : Tmcm142::kSerialInterfaces) {
    identity.serial_interfaces.push_back({.name = std::string(interface)});
  }
  return std::make_shared<Tmcm142Product>(std::move(identity), &kTmcm142Keys);
}

}  // namespace stator::devices
