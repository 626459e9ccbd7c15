#include "stator/devices/tmc8461/product.hpp"

#include "stator/devices/tmc8461/controller.hpp"
#include "stator/devices/tmc8461/keys.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"

namespace stator::devices {

namespace {

/// By its pin, or by its EEPROM (word 0, bit 8) as it leaves its box.
bool emulates(const Tmc8461Configuration& chip) {
  constexpr std::byte kEmulation{0x01};
  return chip.device_emulation ||
         (chip.sii.size() > 1 && (chip.sii[1] & kEmulation) != std::byte{0});
}

class Tmc8461Product final : public product::ProductOf<Tmc8461Configuration, Tmc8461> {
 public:
  using ProductOf::ProductOf;

  [[nodiscard]] bool has_objects(const product::Setup& setup) const override {
    return of(setup).mailbox_bytes > 0 && of(setup).coe;
  }
  [[nodiscard]] bool waits_for_host(const product::Setup& setup) const override {
    return !emulates(of(setup));
  }
  [[nodiscard]] std::span<const ethercat::ControllerPreset> controllers() const override {
    return {&tmc8461::kController, 1};
  }
};

}  // namespace

std::shared_ptr<const product::Product> tmc8461_product() {
  return std::make_shared<Tmc8461Product>(
      product::Identity{.type = "tmc8461",
                        .summary = "slave controller chip with multi-function I/O, TMC8461",
                        .reached_over = "EtherCAT; SPI (socket)",
                        .network = product::NetworkKind::segment,
                        .ports = 2,
                        .own_firmware = false,
                        .host_port = true,
                        .io_block = true},
      &kTmc8461Keys);
}

}  // namespace stator::devices
