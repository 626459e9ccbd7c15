// How masters reach the links of a rack: what is pasted is made for these links, and `stator run`
// prints what it always printed.
#include "stator/rack/run/connections.hpp"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8461/product.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/devices/tmcm_3315/product.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"

namespace stator::rack {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

SegmentConfiguration segment_of(const std::vector<product::Setup>& setups,
                                const std::string& link) {
  SegmentConfiguration segment;
  segment.link = *link::parse_link_address(link);
  for (const product::Setup& setup : setups) {
    segment.devices.push_back({.name = "device", .setup = setup});
  }
  return segment;
}

/// Of one program; fails the test if there is not exactly one.
Connection of(const Connections& connections, const std::string& program) {
  std::vector<Connection> found;
  for (const Connection& each : connections.programs) {
    if (each.program == program) {
      found.push_back(each);
    }
  }
  EXPECT_EQ(found.size(), 1U) << program;
  return found.empty() ? Connection{} : found.front();
}

BusConfiguration bus_of(const std::string& type) {
  return single_device_rack(type, devices::products()).buses.front();
}

TEST(Connections, NameWhatTheSegmentHas) {
  const auto hints = [](const std::vector<product::Setup>& setups, const std::string& link) {
    return printed(connections_of(segment_of(setups, link)));
  };
  const product::Setup chip = devices::tmc8461_product()->defaults();
  product::Setup chip_with_objects = chip;
  chip_with_objects.as<devices::Tmc8461Configuration>().mailbox_bytes = 128;
  chip_with_objects.as<devices::Tmc8461Configuration>().coe = true;
  const product::Setup drive = devices::tmcm_3315_product()->defaults();
  for (const std::string link : {"udp:127.0.0.1", "ethercat:nosuch0"}) {
    EXPECT_THAT(hints({chip}, link), AllOf(HasSubstr("stator scan --link"), Not(HasSubstr("move")),
                                           Not(HasSubstr("-sdo"))));
    EXPECT_THAT(hints({drive}, link),
                AllOf(HasSubstr("stator move --link"), HasSubstr("--revolutions"),
                      Not(HasSubstr("--position"))));
    EXPECT_THAT(hints({chip, chip, drive, drive}, link), HasSubstr("--position 2 --revolutions"));
  }
  EXPECT_THAT(hints({chip}, "ethercat:nosuch0"), HasSubstr("slaveinfo INTERFACE -map"));
  EXPECT_THAT(hints({chip_with_objects}, "ethercat:nosuch0"), HasSubstr("-sdo -map"));
  EXPECT_THAT(hints({drive}, "ethercat:nosuch0"), HasSubstr("-sdo -map"));
}

TEST(Connections, OfAnInterfaceNameItForEveryMaster) {
  const product::Setup drive = devices::tmcm_3315_product()->defaults();
  const Connections tap = connections_of(segment_of({drive, drive}, "tap:drive0"));
  for (const std::string master :
       {"stator", "SOEM", "IgH EtherCAT master", "pysoem", "ethercrab"}) {
    EXPECT_THAT(of(tap, master).lines, HasSubstr("drive0")) << master;
  }
  EXPECT_EQ(of(tap, "TwinCAT").lines, "stator export esi tmcm-3315 -o tmcm-3315.xml");
  EXPECT_THAT(of(tap, "TwinCAT").explanation, HasSubstr("no cable"));
  const Connections raw = connections_of(segment_of({drive}, "ethercat:nosuch0"));
  EXPECT_THAT(of(raw, "TwinCAT").explanation, Not(HasSubstr("no cable")));
}

TEST(Connections, OverUdpSayWhatMastersWithAnInterfaceNeed) {
  const product::Setup drive = devices::tmcm_3315_product()->defaults();
  const Connections udp = connections_of(segment_of({drive}, "udp:0.0.0.0:4000"));
  EXPECT_THAT(udp.where, HasSubstr("send to 127.0.0.1"));
  ASSERT_EQ(udp.programs.size(), 2U);
  EXPECT_THAT(udp.programs[0].lines, HasSubstr("--link udp:127.0.0.1:4000"));
  EXPECT_THAT(udp.programs[1].program, AllOf(HasSubstr("SOEM"), HasSubstr("TwinCAT")));
  EXPECT_THAT(udp.programs[1].lines, HasSubstr("stator run RACK.toml --link ethercat:drive"));
  EXPECT_EQ(udp.programs[1].printed, "");
}

TEST(Connections, OfABusHaveItsNodesItsBitRateAndItsPort) {
  BusConfiguration bus = bus_of("tmcc160");
  *bus.devices.front().setup.node_id() = 5;
  bus.bit_rate = 250'000;
  const Connections slcan = connections_of(bus, "slcan:/tmp/stator-can0");
  EXPECT_THAT(of(slcan, "python-canopen").lines,
              AllOf(HasSubstr(R"(connect(interface="slcan", channel="/tmp/stator-can0", )"
                              "bitrate=250000)"),
                    HasSubstr("in [5]:")));
  EXPECT_THAT(of(slcan, "can-utils").lines,
              AllOf(HasSubstr("slcand -o -s5 $(readlink /tmp/stator-can0) can0"),
                    HasSubstr("cansend can0 605#4000100000000000")));
  bus.bit_rate = std::nullopt;
  EXPECT_THAT(of(connections_of(bus, "slcan:/tmp/stator-can0"), "python-canopen").lines,
              Not(HasSubstr("bitrate")));
  const Connections server = connections_of(bus, "socketcand:0.0.0.0:29536");
  EXPECT_THAT(of(server, "python-can").lines,
              HasSubstr(R"(interface="socketcand", host="127.0.0.1", port=29536)"));
  EXPECT_EQ(of(server, "can-utils").lines, "");
  EXPECT_THAT(of(server, "can-utils").explanation, HasSubstr("can-exec:can0"));
  const Connections exec = connections_of(bus, "can-exec:can0");
  EXPECT_THAT(of(exec, "python-canopen").lines, StartsWith("# to be started by: stator can-exec"));
  EXPECT_THAT(of(exec, "can-utils").lines, HasSubstr("stator can-exec -- cansend can0 605#"));
}

TEST(Connections, OfModulesHaveTheirIdentifiersAndAddresses) {
  RackConfiguration rack = single_device_rack("tmcm-142", devices::products());
  DeviceConfiguration& module = rack.buses.front().devices.front();
  module.setup.tmcl_address()->can = 7;
  module.setup.tmcl_address()->can_reply = 8;
  module.setup.tmcl_address()->serial = 9;
  module.serial = {{"rs485", "pty:/tmp/stator-rs485"}};
  EXPECT_THAT(of(connections_of(rack.buses.front(), "slcan:/tmp/stator-can0"), "PyTrinamic").lines,
              HasSubstr("--interface slcan_tmcl --port /tmp/stator-can0 --data-rate 1000000 "
                        "--module-id 7 --host-id 8"));
  EXPECT_EQ(of(connections_of(rack.buses.front(), "slcan-tcp:4000"), "PyTrinamic").lines, "");
  EXPECT_THAT(of(connections_of(rack.buses.front(), "can-exec:arm"), "PyTrinamic").lines,
              AllOf(StartsWith("# to be started by: stator can-exec --bus arm=can0 -- python3"),
                    HasSubstr("socketcan_tmcl --port can0 ")));
  const Connections line =
      connections_of(rack, {.link = "pty:/tmp/stator-rs485"}, "/tmp/stator-rs485");
  EXPECT_THAT(of(line, "PyTrinamic").lines,
              AllOf(HasSubstr("serial_tmcl --port /tmp/stator-rs485"), HasSubstr("in [9]:")));
  EXPECT_EQ(printed(line),
            "Programs open it:\n"
            "  ConnectionManager(\"--interface serial_tmcl --port /tmp/stator-rs485 --data-rate "
            "9600\").connect()   # PyTrinamic\n"
            "  serial.Serial(\"/tmp/stator-rs485\", 9600)   # pyserial\n");
}

TEST(Connections, LeadOnToDocumentsThatThereAre) {
  const product::Setup drive = devices::tmcm_3315_product()->defaults();
  RackConfiguration rack = single_device_rack("tmcm-142", devices::products());
  rack.buses.front().devices.front().serial = {{"usb", "tcp:4000"}};
  const std::vector<Connections> all = {
      connections_of(segment_of({drive}, "udp:127.0.0.1")),
      connections_of(segment_of({drive}, "ethercat:nosuch0")),
      connections_of(bus_of("tmcc160"), "slcan:/tmp/stator-can0"),
      connections_of(rack.buses.front(), "udp-multicast:"),
      connections_of(rack, {.link = "tcp:4000"}, "127.0.0.1:4000")};
  for (const Connections& each : all) {
    EXPECT_THAT(each.programs, Not(IsEmpty())) << each.where;
    for (const Connection& program : each.programs) {
      const std::filesystem::path docs = STATOR_SOURCE_DIR "/docs";
      EXPECT_TRUE(std::filesystem::exists(docs / program.guide)) << program.guide;
      EXPECT_THAT(program.explanation, Not(IsEmpty())) << program.program;
    }
  }
}

}  // namespace
}  // namespace stator::rack
