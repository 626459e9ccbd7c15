#include "stator/devices/generic/product.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include "stator/devices/generic/completion.hpp"
#include "stator/devices/generic/keys.hpp"
#include "stator/devices/tmc8670/axis_world.hpp"

namespace stator::devices {

namespace {

using dictionary::ImportKind;
using dictionary::ImportReport;
using ethercat::ImportedSlave;
using generic::NodeConfiguration;
using generic::SlaveConfiguration;
using generic::TerminalConfiguration;

/// A name for a device: letters, digits and dashes of its order code.
std::string usual_name(const std::string& order_code) {
  std::string name;
  for (char c : order_code) {
    const bool capital = c >= 'A' && c <= 'Z';
    c = capital ? static_cast<char>(c - 'A' + 'a') : c;
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (name.ends_with('-')) {
    name.pop_back();
  }
  return name.empty() ? "device" : name;
}

unsigned ports_of(const ImportedSlave& file) {
  return static_cast<unsigned>(std::ranges::count_if(file.description.port_physics,
                                                     [](char physics) { return physics != ' '; }));
}

std::vector<product::AxisSetup> setups_of(std::vector<plant::PwmAxisParameters>& axes) {
  std::vector<product::AxisSetup> setups;
  setups.reserve(axes.size());
  for (plant::PwmAxisParameters& axis : axes) {
    setups.push_back({.pwm = &axis});
  }
  return setups;
}

class SlaveProduct final : public product::Product {
 public:
  SlaveProduct(product::Identity identity, ImportedSlave file)
      : identity_(std::move(identity)),
        file_(std::move(file)),
        drives_(generic::count_drives(file_)) {}

  [[nodiscard]] const product::Identity& identity() const override { return identity_; }
  [[nodiscard]] product::Setup defaults() const override {
    SlaveConfiguration configuration;
    configuration.axes.assign(drives_, tmc8670::default_axis());
    return {shared_from_this(), configuration};
  }
  void read_keys(settings::Reader& reader, product::Setup& setup) const override {
    settings::read_keys(generic::kSlaveKeys, reader, setup.as<SlaveConfiguration>());
  }
  [[nodiscard]] std::unique_ptr<product::Device> make(const product::Setup& setup,
                                                      base::EventReporter reporter) const override {
    return std::make_unique<generic::Slave>(file_, setup.as<SlaveConfiguration>(), reporter);
  }
  [[nodiscard]] const product::CoeOptions* coe(const product::Setup& setup) const override {
    return &setup.as<SlaveConfiguration>().coe;
  }
  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return &setup.as<SlaveConfiguration>().quirks;
  }
  [[nodiscard]] std::vector<product::AxisSetup> axes(product::Setup& setup) const override {
    return setups_of(setup.as<SlaveConfiguration>().axes);
  }
  /// Tries it, and has `report` told what is assumed.
  void try_out(ImportReport& report) const {
    const product::Setup setup = defaults();
    const generic::Slave slave(file_, setup.as<SlaveConfiguration>(), {}, &report);
    for (const generic::Drive& drive : slave.drives()) {
      report.add(ImportKind::assumed, 0, "drive-units",
                 "a revolution of a motor is " + std::to_string(drive.position_units()) +
                     " position units, a revolution per second " +
                     std::to_string(static_cast<std::int64_t>(drive.velocity_units())) +
                     " velocity units; position_units and velocity_units of the rack file say "
                     "otherwise");
    }
  }

 private:
  product::Identity identity_;
  ImportedSlave file_;
  unsigned drives_;
};

class TerminalProduct final : public product::Product {
 public:
  TerminalProduct(product::Identity identity, ImportedSlave file)
      : identity_(std::move(identity)), file_(std::move(file)) {}

  [[nodiscard]] const product::Identity& identity() const override { return identity_; }
  [[nodiscard]] product::Setup defaults() const override {
    return {shared_from_this(), TerminalConfiguration{}};
  }
  void read_keys(settings::Reader& reader, product::Setup& setup) const override {
    settings::read_keys(generic::kTerminalKeys, reader, setup.as<TerminalConfiguration>());
  }
  [[nodiscard]] std::unique_ptr<product::Device> make(const product::Setup& setup,
                                                      base::EventReporter reporter) const override {
    return std::make_unique<generic::Terminal>(file_, setup.as<TerminalConfiguration>(), reporter);
  }

 private:
  product::Identity identity_;
  ImportedSlave file_;
};

class NodeProduct final : public product::Product {
 public:
  NodeProduct(product::Identity identity, canopen::EdsFile file)
      : identity_(std::move(identity)), file_(std::move(file)) {
    dictionary::Dictionary objects;
    objects.add(file_.objects.rows());
    objects.finish();
    while (drives_ < generic::kMostAxes && generic::is_drive(objects, drives_)) {
      ++drives_;
    }
  }

  [[nodiscard]] const product::Identity& identity() const override { return identity_; }
  [[nodiscard]] product::Setup defaults() const override {
    NodeConfiguration configuration;
    configuration.axes.assign(drives_, tmc8670::default_axis());
    configuration.node_id = file_.node_id.value_or(configuration.node_id);
    configuration.bit_rate = file_.bit_rate.value_or(configuration.bit_rate);
    return {shared_from_this(), configuration};
  }
  void read_keys(settings::Reader& reader, product::Setup& setup) const override {
    settings::read_keys(generic::kNodeKeys, reader, setup.as<NodeConfiguration>());
  }
  [[nodiscard]] std::unique_ptr<product::Device> make(const product::Setup& setup,
                                                      base::EventReporter reporter) const override {
    return std::make_unique<generic::Node>(file_, setup.as<NodeConfiguration>(), reporter);
  }
  [[nodiscard]] const dictionary::Quirks* quirks(const product::Setup& setup) const override {
    return &setup.as<NodeConfiguration>().quirks;
  }
  [[nodiscard]] const std::uint8_t* node_id(const product::Setup& setup) const override {
    return &setup.as<NodeConfiguration>().node_id;
  }
  [[nodiscard]] std::vector<product::AxisSetup> axes(product::Setup& setup) const override {
    return setups_of(setup.as<NodeConfiguration>().axes);
  }
  void try_out(ImportReport& report) const {
    const product::Setup setup = defaults();
    const generic::Node node(file_, setup.as<NodeConfiguration>(), {}, &report);
  }

 private:
  product::Identity identity_;
  canopen::EdsFile file_;
  unsigned drives_ = 0;
};

/// A declaration that no dictionary takes is the file's, here.
template <typename Make>
auto made(const Make& make) {
  try {
    return make();
  } catch (const std::logic_error& error) {
    throw std::runtime_error(std::string("no device can be made of it: ") + error.what());
  }
}

}  // namespace

std::shared_ptr<const product::Product> imported_product(std::string type, ImportedSlave file,
                                                         ImportReport& report) {
  generic::complete(file, report);
  product::Identity identity{.type = std::move(type),
                             .summary = file.description.name,
                             .reached_over = file.description.coe ? "EtherCAT (CoE)" : "EtherCAT",
                             .network = product::NetworkKind::segment,
                             .ports = std::max(ports_of(file), 1U),
                             .own_firmware = file.description.coe,
                             .usual_name = usual_name(file.description.order_code)};
  return made([&]() -> std::shared_ptr<const product::Product> {
    if (file.description.coe) {
      auto product = std::make_shared<const SlaveProduct>(std::move(identity), std::move(file));
      product->try_out(report);
      return product;
    }
    auto product = std::make_shared<const TerminalProduct>(std::move(identity), std::move(file));
    static_cast<void>(product->make(product->defaults(), {}));
    return product;
  });
}

std::shared_ptr<const product::Product> imported_product(std::string type, canopen::EdsFile file,
                                                         ImportReport& report) {
  generic::complete(file, report);
  product::Identity identity{
      .type = std::move(type),
      .summary = file.product_name,
      .reached_over = "CANopen",
      .network = product::NetworkKind::bus,
      .usual_name = usual_name(file.product_name.empty() ? file.order_code : file.product_name)};
  return made([&]() -> std::shared_ptr<const product::Product> {
    auto product = std::make_shared<const NodeProduct>(std::move(identity), std::move(file));
    product->try_out(report);
    return product;
  });
}

}  // namespace stator::devices
