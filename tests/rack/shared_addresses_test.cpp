// Which devices of a rack are reported for having the same node-ID, CAN identifier or serial
// address.
#include "stator/rack/file/shared_addresses.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::rack {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> shared(const std::string& text) {
  return shared_addresses(parse_rack_file(text, "test.toml", devices::products()));
}

/// "[[bus.device]]" of a drive or module.
std::string device(const std::string& type, const std::string& name, const std::string& rest) {
  return "[[bus.device]]\ntype = \"" + type + "\"\nname = \"" + name + "\"\n" + rest;
}

TEST(SharedAddresses, OfOneBusAreToldWithTheirHolders) {
  const std::string rack =
      "[[bus]]\nports = [\"slcan-tcp:0\"]\n" + device("tmcc160", "lift", "node_id = 5\n") +
      device("tmcc160", "spindle", "node_id = 6\n") + device("tmcc160", "table", "node_id = 5\n");
  EXPECT_THAT(
      shared(rack),
      ElementsAre("node-ID 5 is given to 2 devices of can0 (lift, table), so they answer each "
                  "SDO together and their frames collide; give each its own \"node_id\""));
}

TEST(SharedAddresses, OfTwoBusesAreTheirOwn) {
  EXPECT_THAT(shared("[[bus]]\nports = [\"slcan-tcp:0\"]\n" + device("tmcc160", "a", "") +
                     "[[bus]]\nports = [\"slcan-tcp:0\"]\n" + device("tmcc160", "b", "")),
              IsEmpty());
}

TEST(SharedAddresses, ModulesHaveThemOnTheBusAndOnTheirLine) {
  const std::string line = "rs485 = \"pty:/tmp/line\"\n";
  const auto told = shared("[[bus]]\nports = [\"slcan-tcp:0\"]\n" + device("tmcm-142", "a", line) +
                           device("tmcm-142", "b", line));
  ASSERT_EQ(told.size(), 2U);
  EXPECT_THAT(told[0], HasSubstr("CAN identifier 1 is given to 2 devices of can0 (a, b)"));
  EXPECT_THAT(told[1], HasSubstr("address 1 is given to 2 devices of pty:/tmp/line (a, b)"));

  EXPECT_THAT(shared("[[bus]]\nports = [\"slcan-tcp:0\"]\n" + device("tmcm-142", "a", line) +
                     device("tmcm-142", "b", line + "address = 2\ncan_id = 3\n")),
              IsEmpty());
}

TEST(SharedAddresses, SwitchesOfAModuleCount) {
  const auto module = [](const std::string& name, const std::string& line, int switches) {
    return "[[device]]\ntype = \"tmcm-142\"\nname = \"" + name + "\"\n" + line +
           " = \"pty:/tmp/line\"\n[device.dip_switches]\naddress = " + std::to_string(switches) +
           "\n";
  };
  EXPECT_THAT(shared(module("a", "rs422", 0) + module("b", "rs422", 1)), IsEmpty());
  EXPECT_THAT(shared(module("a", "rs485", 0) + module("b", "rs485", 1)),
              ElementsAre(HasSubstr("address 1 is given")))
      << "the switches count on RS-422 only";
}

TEST(SharedAddresses, OfModulesWithoutABusAreNone) {
  EXPECT_THAT(shared("[[device]]\ntype = \"tmcm-142\"\nname = \"a\"\nusb = \"pty:/tmp/a\"\n"
                     "[[device]]\ntype = \"tmcm-142\"\nname = \"b\"\nusb = \"pty:/tmp/b\"\n"),
              IsEmpty());
}

}  // namespace
}  // namespace stator::rack
