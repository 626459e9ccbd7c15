#include "stator/devices/tmc8461/product.hpp"

#include "stator/devices/tmc8461/controller.hpp"
#include "stator/devices/tmc8461/keys.hpp"
#include "stator/devices/tmc8461/mfc_configuration_keys.hpp"
#include "stator/devices/tmc8461/sii.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/product/catalogue/io_configuration.hpp"

namespace stator::devices {

namespace {

/// By its pin, or by its EEPROM (word 0, bit 8) as it leaves its box.
bool emulates(const Tmc8461Configuration& chip) {
  constexpr std::byte kEmulation{0x01};
  return chip.device_emulation ||
         (chip.sii.size() > 1 && (chip.sii[1] & kEmulation) != std::byte{0});
}

class BlockConfiguration final : public product::IoConfiguration {
 public:
  void read(settings::Reader& root) override { tmc8461::read_mfc_configuration(root, file_); }
  void take(const ethercat::SiiContents& contents) override {
    file_.configuration = mfc::Configuration(contents.parameter_ram);
    file_.identity.vendor_id = contents.vendor_id;
    file_.identity.product_code = contents.product_code;
    file_.identity.revision = contents.revision;
    file_.identity.serial_number = contents.serial_number;
    file_.identity.name = contents.name;
    file_.identity.order_code = contents.order_code;
    file_.identity.group = contents.group;
    file_.identity.station_alias = contents.station_alias;
    file_.identity.device_emulation = (contents.pdi_control & 0x0100) != 0;
    file_.identity.distributed_clocks = (contents.pdi_control & 0x0C00) != 0;
    file_.identity.sync_pulse_length = contents.sync_pulse_length;
    file_.identity.sii_size_kbit = contents.size_kbit;
  }

  [[nodiscard]] std::string text() const override { return tmc8461::mfc_configuration_text(file_); }
  [[nodiscard]] ethercat::SiiContents sii_contents() const override {
    return tmc8461::sii_contents(file_.configuration, file_.identity);
  }
  [[nodiscard]] const std::string& vendor_name() const override {
    return file_.identity.vendor_name;
  }
  [[nodiscard]] const mfc::Configuration& block() const override { return file_.configuration; }

 private:
  tmc8461::MfcConfigurationFile file_;
};

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
  [[nodiscard]] std::unique_ptr<product::IoConfiguration> io_configuration() const override {
    return std::make_unique<BlockConfiguration>();
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
                        .host_port = true},
      &kTmc8461Keys);
}

}  // namespace stator::devices
