// A program's own bench: loads a rack, goes to Operational, finds devices and signals by name, arms
// faults.
#include "stator/bench/bench.hpp"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/product/device/device.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/settings/value.hpp"

namespace stator::bench {
namespace {

using namespace base::literals;

TEST(Bench, TimePassesInCycles) {
  Bench bench(rack::parse_rack_file("cycle = \"2ms\"\n[[segment]]\n[[segment.device]]\n"
                                    "type = \"tmcm-3315\"\nname = \"module\"\n",
                                    "test.toml", devices::products()),
              1_s);
  bench.cycle();
  EXPECT_EQ(bench.now(), base::SimTime(2_ms));
  bench.pass(9_ms);
  EXPECT_EQ(bench.now(), base::SimTime(12_ms));
  EXPECT_FALSE(bench.wait_until([] { return false; }, 10_ms));
  EXPECT_EQ(bench.now(), base::SimTime(22_ms));
}

TEST(Bench, EndsAtItsLimit) {
  Bench bench(rack::parse_rack_file("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n"
                                    "name = \"module\"\n",
                                    "test.toml", devices::products()),
              10_ms);
  EXPECT_THROW(bench.pass(1_s), TimeLimitReached);
  EXPECT_EQ(bench.now(), base::SimTime(10_ms));
}

TEST(Bench, WritesNoFiles) {
  const rack::RackConfiguration configuration = rack::parse_rack_file(
      "state = \"/nosuch/state\"\n[record]\nfile = \"/nosuch/x.csv\"\n[[bus]]\nlog = "
      "\"/nosuch/can.log\"\n[[bus.device]]\ntype = \"tmcc160\"\nname = \"drive\"\n",
      "test.toml", devices::products());
  EXPECT_NO_THROW(Bench(configuration, 1_s));
}

/// A module on EtherCAT and a drive on CAN.
rack::RackConfiguration two_networks() {
  using settings::List;
  using settings::Table;
  const Table module{{"type", "tmcm-3315"}, {"name", "module"}};
  const Table drive{{"type", "tmcc160"}, {"name", "drive"}, {"node_id", 3}};
  return load({{"segment", List{Table{{"device", List{module}}}}},
               {"bus", List{Table{{"device", List{drive}}}}}},
              devices::products());
}

/// What a call throws.
template <typename Call>
std::string thrown_by(const Call& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Bench, FindsDevicesAndSignalsByName) {
  Bench bench(two_networks());
  ASSERT_TRUE(bench.find("drive"));
  EXPECT_EQ(bench.find("drive")->kind, rack::NetworkKind::bus);
  EXPECT_EQ(bench.node_id(*bench.find("drive")), 3);
  EXPECT_FALSE(bench.find("gantry"));
  EXPECT_EQ(bench.signal("module.axis0.shaft_position").unit, "rev");
  EXPECT_EQ(bench.signal("module.axis0.shaft_position").read(), 0.0);
  EXPECT_EQ(thrown_by([&] { static_cast<void>(bench.signal("module.axis0.shaft_positon")); }),
            "there is no signal \"module.axis0.shaft_positon\"; did you mean "
            "\"module.axis0.shaft_position\"?");
}

TEST(Bench, WhatAProgramsTableHasWrongIsSaidWithoutAPlace) {
  EXPECT_EQ(thrown_by([] {
              static_cast<void>(load(settings::Table{}, devices::products()));
            }).substr(0, 21),
            "a rack needs at least");
}

TEST(Bench, GoesOperationalOnAllNetworks) {
  Bench bench(two_networks());
  const auto reached = bench.go_operational();
  ASSERT_TRUE(reached) << reached.error().text;
  bench.pass(2_ms);
  for (const rack::DeviceAddress device : bench.rack().addresses()) {
    const auto status = bench.rack().device(device).network_status();
    EXPECT_TRUE(status.state == "Operational" || status.state == "Op") << status.state;
  }
}

TEST(Bench, ArmsFaultsThatAProgramNames) {
  Bench bench(two_networks());
  const std::uint64_t fault =
      bench.inject({{"kind", "motor-stall"}, {"device", "module"}, {"axis", 1}, {"at", "5ms"}});
  EXPECT_EQ(bench.rack().faults(bench.now()).size(), 1U);
  bench.pass(10_ms);
  EXPECT_EQ(bench.rack().faults(bench.now()).front().state, rack::FaultState::active);
  bench.clear_faults(fault);
  EXPECT_EQ(bench.rack().faults(bench.now()).front().state, rack::FaultState::done);
  EXPECT_EQ(thrown_by([&] {
              bench.inject({{"kind", "motor-stal"}, {"device", "module"}});
            }).substr(0, 22),
            "\"kind\" is \"motor-stal\"");
}

}  // namespace
}  // namespace stator::bench
