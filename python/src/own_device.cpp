#include "own_device.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "stator/canopen/eds/eds.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/shell/canopen_firmware.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/ethercat_firmware.hpp"
#include "stator/product/shell/quirk_keys.hpp"
#include "stator/settings/section.hpp"

namespace nb = nanobind;

namespace stator::python {

namespace {

/// What a rack file can say of one.
struct Configuration {
  product::CoeOptions coe{};
  dictionary::Quirks quirks{};
  std::uint8_t node_id = 1;
};

constexpr std::array kSegmentRows{
    settings::keys<product::kCoeKeys, &Configuration::coe>(),
    settings::keys<product::kCoeQuirkKeys, &Configuration::quirks>(),
};
constexpr settings::Section<Configuration> kSegmentKeys{kSegmentRows};
constexpr std::array kBusRows{
    settings::whole<&Configuration::node_id>("node_id", {1, 127}, "Of the device on its bus"),
};
constexpr settings::Section<Configuration> kBusKeys{kBusRows};

using Make = std::function<nb::object()>;

/// What both kinds of devices give their instance of Python.
template <typename Firmware, typename FirmwareOutline>
class OwnDevice : public Firmware, public Behaviour {
 protected:
  OwnDevice(const FirmwareOutline& firmware, const std::shared_ptr<const Outline>& outline,
            const Make& make, std::shared_ptr<DeviceFailure> failure, base::EventReporter reporter)
      : Firmware(firmware, reporter), Behaviour(outline, make, std::move(failure)) {}
  /// A device's own constructor calls it: functions of Python may send emergencies, which a base
  /// class's constructor cannot reach.
  void begin() {
    connect();
    start(base::SimTime());
  }

 private:
  void tick(base::SimTime now) final { step(now); }
  dictionary::Dictionary& own_objects() final { return this->objects(); }
  [[nodiscard]] const base::EventReporter& own_reporter() const final { return this->reporter(); }
  [[nodiscard]] std::string_view network_state_text() const final {
    return this->network_status().state;
  }
};

class SegmentDevice final : public OwnDevice<product::EtherCatFirmware, product::EtherCatOutline> {
 public:
  SegmentDevice(const std::shared_ptr<const Outline>& outline, const Configuration& configuration,
                const Make& make, std::shared_ptr<DeviceFailure> failure,
                base::EventReporter reporter)
      : OwnDevice({.vendor = outline->vendor,
                   .code = outline->code,
                   .revision = outline->revision,
                   .name = outline->name,
                   .objects = outline->objects,
                   .period = outline->period,
                   .coe = configuration.coe,
                   .quirks = configuration.quirks},
                  outline, make, std::move(failure), reporter) {
    begin();
  }

 private:
  void restart(base::SimTime now) override { start(now); }
  void send(std::uint16_t code, std::uint8_t error_register,
            const std::array<std::uint8_t, 5>& additional, base::SimTime now) override {
    send_emergency(code, error_register, additional, now);
  }
};

class BusDevice final : public OwnDevice<product::CanOpenFirmware, product::CanOpenOutline> {
 public:
  BusDevice(const std::shared_ptr<const Outline>& outline, const Configuration& configuration,
            const Make& make, std::shared_ptr<DeviceFailure> failure, base::EventReporter reporter)
      : OwnDevice({.node_id = configuration.node_id,
                   .vendor = outline->vendor,
                   .code = outline->code,
                   .revision = outline->revision,
                   .name = outline->name,
                   .objects = outline->objects,
                   .period = outline->period,
                   .bit_rate = outline->bit_rate},
                  outline, make, std::move(failure), reporter) {
    begin();
    const std::array<std::int64_t, 1> bit_rates{outline->bit_rate / 1000};
    eds_ = canopen::eds_text(objects(), {.file_name = outline->type + ".eds",
                                         .title = outline->name,
                                         .date = "01-01-2026",
                                         .product_name = outline->name,
                                         .order_code = outline->name,
                                         .bit_rates = bit_rates});
  }
  [[nodiscard]] std::string_view eds() const override { return eds_; }

 private:
  void load_application(base::SimTime now) override { start(now); }
  /// Code 0000h says that all errors are gone.
  void send(std::uint16_t code, std::uint8_t error_register,
            const std::array<std::uint8_t, 5>& additional, base::SimTime now) override {
    if (code == 0) {
      emergency_producer().forget();
      emergency_producer().report_reset(now);
    } else {
      emergency_producer().raise(
          {.code = code, .error_register = error_register, .information = additional}, now);
    }
  }

  std::string eds_;
};

/// A product of which devices are made by a function of Python.
class OwnProduct final : public product::Product {
 public:
  OwnProduct(std::shared_ptr<const Outline> outline, nb::object factory,
             std::shared_ptr<DeviceFailure> failure)
      : outline_(std::move(outline)), factory_(std::move(factory)), failure_(std::move(failure)) {
    constexpr unsigned kPorts = 2;
    identity_ = {.type = outline_->type,
                 .summary = "a device in Python",
                 .network = outline_->network,
                 .ports = on_bus() ? 0 : kPorts};
  }
  OwnProduct(const OwnProduct&) = delete;
  OwnProduct& operator=(const OwnProduct&) = delete;
  ~OwnProduct() override {
    const nb::gil_scoped_acquire interpreter;
    factory_.reset();
  }

  [[nodiscard]] const product::Identity& identity() const override { return identity_; }
  [[nodiscard]] product::Setup defaults() const override {
    return {shared_from_this(), Configuration{}};
  }
  void read_keys(settings::Reader& reader, product::Setup& setup) const override {
    settings::read_keys(on_bus() ? kBusKeys : kSegmentKeys, reader, setup.as<Configuration>());
  }
  [[nodiscard]] std::unique_ptr<product::Device> make(const product::Setup& setup,
                                                      base::EventReporter reporter) const override {
    const auto& configuration = setup.as<Configuration>();
    const Make make = [this] { return factory_(); };
    try {
      if (on_bus()) {
        return std::make_unique<BusDevice>(outline_, configuration, make, failure_, reporter);
      }
      return std::make_unique<SegmentDevice>(outline_, configuration, make, failure_, reporter);
    } catch (const std::logic_error& error) {
      // Of declarations, which here are the user's.
      throw std::runtime_error(fmt::format("{}: {}", outline_->type, error.what()));
    }
  }
  [[nodiscard]] const product::CoeOptions* coe(const product::Setup& setup) const override {
    return on_bus() ? nullptr : &setup.as<Configuration>().coe;
  }
  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return on_bus() ? nullptr : &setup.as<Configuration>().quirks;
  }
  [[nodiscard]] const std::uint8_t* node_id(const product::Setup& setup) const override {
    return on_bus() ? &setup.as<Configuration>().node_id : nullptr;
  }

 private:
  [[nodiscard]] bool on_bus() const { return outline_->network == product::NetworkKind::bus; }

  std::shared_ptr<const Outline> outline_;
  nb::object factory_;
  std::shared_ptr<DeviceFailure> failure_;
  product::Identity identity_;
};

}  // namespace

void add_own_products(product::Catalogue& catalogue, nb::handle factories,
                      const std::shared_ptr<DeviceFailure>& failure) {
  for (const nb::handle each : factories) {
    auto outline = std::make_shared<const Outline>(read_outline(each));
    catalogue.add(std::make_shared<OwnProduct>(std::move(outline), nb::borrow(each), failure));
  }
}

nb::object instance_of(const product::Device& device) {
  const auto* const behaviour = dynamic_cast<const Behaviour*>(&device);
  return behaviour != nullptr ? behaviour->instance() : nb::none();
}

}  // namespace stator::python
