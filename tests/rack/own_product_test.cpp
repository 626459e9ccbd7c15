// Products that a program adds to the catalogue, in rack files and racks.

#include <memory>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/test_can_device.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using ::testing::HasSubstr;

/// Ours and two probes, of which one says that it belongs into a segment and is a CAN device.
product::Catalogue catalogue() {
  const auto make_probe = [](base::EventReporter /*reporter*/) {
    return std::make_unique<tests::TestCanDevice>(tests::TestCanDevice::Settings{});
  };
  product::Catalogue all = devices::products();
  all.add(product::make_product({.type = "probe", .network = NetworkKind::bus}, make_probe));
  all.add(product::make_product({.type = "lost", .network = NetworkKind::segment}, make_probe));
  return all;
}

TEST(OwnProduct, StandsInARackFileBesideOurs) {
  const RackConfiguration configuration = parse_rack_file(R"(
[[bus]]
[[bus.device]]
type = "probe"
name = "own"
[[bus.device]]
type = "tmcc160"
node_id = 2
)",
                                                          "test.toml", catalogue());
  EventLog log;
  Rack rack(configuration, log);
  const DeviceAddress own{0, 0, NetworkKind::bus};
  ASSERT_THAT(rack.addresses(), testing::SizeIs(2));
  EXPECT_EQ(rack.name_of(own), "own");
  EXPECT_NE(dynamic_cast<const tests::TestCanDevice*>(&rack.device(own)), nullptr);
}

TEST(OwnProduct, IsUnknownToThoseWhoWereNotGivenIt) {
  const std::string text = "[[bus]]\n[[bus.device]]\ntype = \"probe\"\n";
  EXPECT_THROW(static_cast<void>(parse_rack_file(text, "test.toml", devices::products())),
               std::runtime_error);
}

TEST(OwnProduct, ThatMakesAnotherKindOfDeviceThanItSaysIsRefused) {
  const RackConfiguration configuration = parse_rack_file(
      "[[segment]]\n[[segment.device]]\ntype = \"lost\"\n", "test.toml", catalogue());
  EventLog log;
  try {
    const Rack rack(configuration, log);
    FAIL() << "built a rack";
  } catch (const std::logic_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"lost\" makes devices that do not belong"));
  }
}

}  // namespace
}  // namespace stator::rack
