#include "stator/devices/tmcc160/product.hpp"

#include "stator/devices/tmcc160/keys.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {

namespace {

class Tmcc160Product final : public product::ProductOf<Tmcc160Configuration, Tmcc160> {
 public:
  using ProductOf::ProductOf;

  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return &of(setup).quirks;
  }
  [[nodiscard]] const std::uint8_t* node_id(const product::Setup& setup) const override {
    return &of(setup).node_id;
  }
  [[nodiscard]] std::vector<product::AxisSetup> axes(product::Setup& setup) const override {
    return {{.servo = &of(setup).axis}};
  }
  /// Six steps of its hall sensors for each of four pole pairs, and rpm.
  [[nodiscard]] std::optional<product::MotionUnits> motion_units() const override {
    return product::MotionUnits{.position = 24.0, .velocity = 60.0};
  }
};

}  // namespace

std::shared_ptr<const product::Product> tmcc160_product() {
  return std::make_shared<Tmcc160Product>(
      product::Identity{
          .type = "tmcc160",
          .summary = "servo drive for a three-phase motor, CiA 402, TMCC160",
          .reached_over = "CAN (CANopen)",
          .network = product::NetworkKind::bus,
          .serial_interfaces = {{.name = std::string(Tmcc160::kSerialInterfaces[0])}}},
      &kTmcc160Keys);
}

}  // namespace stator::devices
