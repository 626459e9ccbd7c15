#include "stator/devices/tmc8670/product.hpp"

#include "stator/devices/tmc8670/hardware_uart.hpp"
#include "stator/devices/tmc8670/internal/controllers.hpp"
#include "stator/devices/tmc8670/internal/tuning.hpp"
#include "stator/devices/tmc8670/keys.hpp"
#include "stator/devices/tmc8670/mcu_uart.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"

namespace stator::devices {

namespace {

class Tmc8670Product final : public product::ProductOf<Tmc8670Configuration, Tmc8670> {
 public:
  using ProductOf::ProductOf;

  [[nodiscard]] const product::CoeOptions* coe(const product::Setup& setup) const override {
    return &of(setup).coe;
  }
  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return &of(setup).quirks;
  }
  [[nodiscard]] std::vector<product::AxisSetup> axes(product::Setup& setup) const override {
    return {{.pwm = &of(setup).axis}};
  }
  /// 608Fh:01, and rpm.
  [[nodiscard]] std::optional<product::MotionUnits> motion_units() const override {
    return product::MotionUnits{.position = 65'536.0, .velocity = 60.0};
  }
  [[nodiscard]] std::span<const ethercat::ControllerPreset> controllers() const override {
    return tmc8670::kControllers;
  }
  [[nodiscard]] const product::Tuning* tuning() const override { return &tuning_; }

 private:
  tmc8670::Tuning tuning_;
};

}  // namespace

std::shared_ptr<const product::Product> tmc8670_product() {
  return std::make_shared<Tmc8670Product>(
      product::Identity{
          .type = "tmc8670",
          .summary = "servo drive in a chip, field-oriented control, CiA 402, TMC8670",
          .reached_over = "EtherCAT (CoE, FoE)",
          .network = product::NetworkKind::segment,
          .ports = 2,
          .serial_interfaces = {{.name = std::string(Tmc8670::kSerialInterfaces[0]),
                                 .baud_rate = tmc8670::McuUart::kBaudRate},
                                {.name = std::string(Tmc8670::kSerialInterfaces[1]),
                                 .protocol = product::SerialProtocol::registers,
                                 .baud_rate = tmc8670::HardwareUart::kDefaultBaudRate}}},
      &kTmc8670Keys);
}

}  // namespace stator::devices
