#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/product/catalogue/identity.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/catalogue/setup.hpp"
#include "stator/product/device/device.hpp"
#include "stator/settings/section.hpp"

namespace stator::ethercat {
struct ControllerPreset;
}
namespace stator::plant {
struct StepperAxisParameters;
}
namespace stator::tmcl {
struct ModuleDescription;
}

namespace stator::product {

class AxisBench;
class IoConfiguration;
class Tuning;

/// A product that can be run: what it is, how one is configured and built, and what a device that
/// is not built yet has. Constant for those of this project, made at run time for one from a file
/// or of a program's own. Belongs to a std::shared_ptr, which a Setup keeps.
class Product : public std::enable_shared_from_this<Product> {
 public:
  Product() = default;
  Product(const Product&) = delete;
  Product& operator=(const Product&) = delete;
  virtual ~Product() = default;

  /// What it is, whatever it is configured to.
  [[nodiscard]] virtual const Identity& identity() const = 0;
  /// As it leaves its box.
  [[nodiscard]] virtual Setup defaults() const = 0;
  /// Reads the product's own keys of a device's table over what `setup` has: those it adds to what
  /// every device has (type, name, serial lines, wiring). Also called to describe them.
  virtual void read_keys(settings::Reader& /*reader*/, Setup& /*setup*/) const {}
  /// Builds a device of its network's kind: an EtherCatDevice for a segment, a CanDevice for a bus.
  /// Throws std::logic_error if the setup is another product's or contradicts itself.
  [[nodiscard]] virtual std::unique_ptr<Device> make(const Setup& setup,
                                                     base::EventReporter reporter) const = 0;

  // What a setup of this product has; nothing by default. The pointers lead into the setup.
  /// Of a device with a CoE mailbox of its own.
  [[nodiscard]] virtual const CoeOptions* coe(const Setup& /*setup*/) const { return nullptr; }
  /// What it does otherwise than it should.
  [[nodiscard]] virtual const dictionary::Quirks* quirks(const Setup& /*setup*/) const {
    return nullptr;
  }
  /// Of a node on CANopen.
  [[nodiscard]] virtual const std::uint8_t* node_id(const Setup& /*setup*/) const {
    return nullptr;
  }
  /// Of a module with TMCL that is addressed.
  [[nodiscard]] virtual const TmclAddress* tmcl_address(const Setup& /*setup*/) const {
    return nullptr;
  }
  /// What is around each of its axes.
  [[nodiscard]] virtual std::vector<AxisSetup> axes(Setup& /*setup*/) const { return {}; }

  /// Of its axes; nothing: it has none, or its units are not known.
  [[nodiscard]] virtual std::optional<MotionUnits> motion_units() const { return std::nullopt; }

  /// Ports for EtherCAT cables.
  [[nodiscard]] virtual unsigned ports(const Setup& /*setup*/) const { return identity().ports; }
  /// Its serial interfaces as they are configured.
  [[nodiscard]] virtual std::vector<SerialInterface> serial_interfaces(
      const Setup& /*setup*/) const {
    return identity().serial_interfaces;
  }
  /// The identifier by which commands of TMCL reach it on CAN, with what switches on its board add;
  /// nothing: it has none, or its interface is switched off.
  [[nodiscard]] virtual std::optional<unsigned> tmcl_identifier(const Setup& /*setup*/) const {
    return std::nullopt;
  }
  /// The same for its address on a serial interface.
  [[nodiscard]] virtual std::optional<unsigned> tmcl_address_on(
      const Setup& /*setup*/, std::string_view /*interface*/) const {
    return std::nullopt;
  }
  /// Masters can list its objects.
  [[nodiscard]] virtual bool has_objects(const Setup& /*setup*/) const {
    return identity().own_firmware;
  }
  /// Without a firmware at its pins it stays in Init.
  [[nodiscard]] virtual bool waits_for_host(const Setup& /*setup*/) const { return false; }

  /// Its slave controller in each reading of its documents, the default first; nothing: its
  /// registers are not described, or it has none.
  [[nodiscard]] virtual std::span<const ethercat::ControllerPreset> controllers() const;

  /// Of its multi-function I/O block (MFC), as an EEPROM leaves it that says nothing of it; null:
  /// it has no such block.
  [[nodiscard]] virtual std::unique_ptr<IoConfiguration> io_configuration() const;

  /// A module as it leaves its box with one axis wired to what `axis` says, for a test bench;
  /// `full_scale_current` is that of AxisSetup. Null: it has no axis that can be commanded so.
  [[nodiscard]] virtual std::unique_ptr<AxisBench> axis_bench(
      const plant::StepperAxisParameters& axis, double full_scale_current) const;
  /// How its controllers are tuned; null: they cannot be.
  [[nodiscard]] virtual const Tuning* tuning() const { return nullptr; }

  /// For which programs in TMCL are written, and which its devices' tmcl_firmware() runs; null: it
  /// runs none.
  [[nodiscard]] virtual const tmcl::ModuleDescription* tmcl_module() const { return nullptr; }
};

/// A product whose devices are of the class `DeviceClass`, made from a `Configuration` and an event
/// reporter.
template <typename Configuration, typename DeviceClass>
class ProductOf : public Product {
 public:
  /// `keys` are those of a rack file that fill a configuration; they must outlive the product, as
  /// constants do. Null: it has none.
  explicit ProductOf(Identity identity, const settings::Section<Configuration>* keys = nullptr)
      : identity_(std::move(identity)), keys_(keys) {}

  /// That it was made with.
  [[nodiscard]] const Identity& identity() const override { return identity_; }
  [[nodiscard]] Setup defaults() const override { return {shared_from_this(), Configuration{}}; }
  [[nodiscard]] std::unique_ptr<Device> make(const Setup& setup,
                                             base::EventReporter reporter) const override {
    return std::make_unique<DeviceClass>(of(setup), reporter);
  }
  void read_keys(settings::Reader& reader, Setup& setup) const override {
    if (keys_ != nullptr) {
      settings::read_keys(*keys_, reader, of(setup));
    }
  }

 protected:
  /// The configuration in a setup of this product.
  [[nodiscard]] static const Configuration& of(const Setup& setup) {
    return setup.as<Configuration>();
  }
  /// The same.
  [[nodiscard]] static Configuration& of(Setup& setup) { return setup.as<Configuration>(); }

 private:
  Identity identity_;
  const settings::Section<Configuration>* keys_;
};

/// A product whose devices are of the class `DeviceClass`, made from a `Configuration` and an event
/// reporter. Of the configuration members called `coe` (CoeOptions), `quirks` (dictionary::Quirks)
/// and `node_id` (std::uint8_t) are what the product has, see Product. `keys` are those of a rack
/// file; they must outlive the product, as constants do. One on a segment has two ports unless
/// `identity` says otherwise.
template <typename Configuration, typename DeviceClass>
[[nodiscard]] std::shared_ptr<const Product> make(Identity identity,
                                                  const settings::Section<Configuration>& keys) {
  class Made final : public ProductOf<Configuration, DeviceClass> {
   public:
    using ProductOf<Configuration, DeviceClass>::ProductOf;

    [[nodiscard]] const CoeOptions* coe(const Setup& setup) const override {
      if constexpr (requires(const Configuration& one) { one.coe; }) {
        return &this->of(setup).coe;
      }
      return nullptr;
    }
    [[nodiscard]] const dictionary::Quirks* quirks(const Setup& setup) const override {
      if constexpr (requires(const Configuration& one) { one.quirks; }) {
        return &this->of(setup).quirks;
      }
      return nullptr;
    }
    [[nodiscard]] const std::uint8_t* node_id(const Setup& setup) const override {
      if constexpr (requires(const Configuration& one) { one.node_id; }) {
        return &this->of(setup).node_id;
      }
      return nullptr;
    }
  };
  constexpr unsigned kPorts = 2;
  if (identity.network == NetworkKind::segment && identity.ports == 0) {
    identity.ports = kPorts;
  }
  return std::make_shared<Made>(std::move(identity), &keys);
}

using DeviceMaker = std::function<std::unique_ptr<Device>(base::EventReporter)>;

/// A product of a program's own that has nothing to be configured; `maker` builds its devices.
[[nodiscard]] std::shared_ptr<const Product> make_product(Identity identity, DeviceMaker maker);

}  // namespace stator::product
