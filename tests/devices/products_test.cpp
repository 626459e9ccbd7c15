// What products say of themselves is true of the devices they make.

#include "stator/devices/catalogue/products.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/product/catalogue/io_configuration.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::devices {
namespace {

TEST(Products, SayOfThemselvesWhatIsTrueOfTheirDevices) {
  ASSERT_EQ(products().products().size(), 6U);
  for (const auto& product : products().products()) {
    const product::Identity& identity = product->identity();
    SCOPED_TRACE(identity.type);
    product::Setup setup = product->defaults();
    EXPECT_EQ(&setup.product(), product.get());
    const auto device = setup.make();
    auto* const slave = dynamic_cast<product::EtherCatDevice*>(device.get());
    const auto* const node = dynamic_cast<const product::CanDevice*>(device.get());
    EXPECT_EQ(slave != nullptr, identity.network == product::NetworkKind::segment);
    EXPECT_EQ(node != nullptr, identity.network == product::NetworkKind::bus);

    std::vector<std::string> interfaces;
    for (const std::string_view name : device->serial_interfaces()) {
      interfaces.emplace_back(name);
    }
    EXPECT_EQ(identity.serial_interface_names(), interfaces);
    EXPECT_EQ(product->tmcl_module() != nullptr, device->tmcl_firmware() != nullptr);
    EXPECT_EQ(setup.coe() != nullptr, slave != nullptr && slave->slave_stack() != nullptr);
    if (slave != nullptr) {
      EXPECT_EQ(identity.own_firmware, slave->slave_stack() != nullptr);
      EXPECT_EQ(identity.host_port, slave->host_port() != nullptr);
      EXPECT_EQ(product->io_configuration() != nullptr, slave->traced_pins().has_value());
      EXPECT_EQ(product->has_objects(setup), slave->object_dictionary() != nullptr);
    }
    const std::vector<product::Input> inputs = device->inputs();
    const auto axes = static_cast<std::size_t>(std::ranges::count_if(
        inputs, [](const product::Input& input) { return input.name.ends_with(".load_torque"); }));
    EXPECT_EQ(setup.axes().size(), axes);
    for (const product::Input& input : inputs) {
      EXPECT_NE(input.group, product::InputGroup::other) << input.name;
      EXPECT_LE(input.minimum, input.normal) << input.name;
      EXPECT_GE(input.maximum, input.normal) << input.name;
    }
  }
}

}  // namespace
}  // namespace stator::devices
