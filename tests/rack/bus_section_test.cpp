// [[bus]] of a rack file, and [[event]] for what is on it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kOneDrive = R"(
[[bus]]
[[bus.device]]
type = "tmcc160"
name = "lift"
)";

RackConfiguration parse(const std::string& text) {
  return parse_rack_file(text, "test.toml", devices::products());
}

std::string refusal_of(const std::string& text) {
  try {
    (void)parse(text);
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal_of_event(const std::string& keys) {
  return refusal_of(kOneDrive + ("[[event]]\nat = \"1s\"\n" + keys));
}

TEST(BusSection, SaysLittleAndGetsTheDefaults) {
  const RackConfiguration rack = parse(kOneDrive);
  ASSERT_EQ(rack.buses.size(), 1U);
  EXPECT_TRUE(rack.segments.empty());
  const BusConfiguration& bus = rack.buses[0];
  EXPECT_EQ(bus.name, "can0");
  EXPECT_EQ(bus.bit_rate, 1'000'000U);
  EXPECT_TRUE(bus.ports_acknowledge);
  EXPECT_TRUE(bus.ports.empty());
  EXPECT_EQ(bus.devices.at(0).name, "lift");
  EXPECT_EQ(bus.devices[0].setup.as<devices::Tmcc160Configuration>().node_id, 1);
}

TEST(BusSection, EveryKeyIsTaken) {
  const RackConfiguration rack = parse(R"(
[[bus]]
name = "left"
bit_rate = 250
ports = ["slcan:/tmp/can", "socketcand:29536"]
ports_acknowledge = false
log = "can.log"
capture = "can.pcap"
cpu = 1
[[bus.device]]
type = "tmcc160"
node_id = 5
bit_rate = 250
boot_time = "0ms"
friendly = true
status_event_timer = "20ms"
lss = false
serial = "pty:/tmp/serial"
[bus.device.axis]
load.inertia = 1e-4
[[bus]]
bit_rate = "unlimited"
[[bus.device]]
type = "tmcc160"
name = "other"
)");
  ASSERT_EQ(rack.buses.size(), 2U);
  const BusConfiguration& bus = rack.buses[0];
  EXPECT_EQ(bus.name, "left");
  EXPECT_EQ(bus.bit_rate, 250'000U);
  EXPECT_THAT(bus.ports, ElementsAre("slcan:/tmp/can", "socketcand:29536"));
  EXPECT_FALSE(bus.ports_acknowledge);
  EXPECT_EQ(bus.log, "can.log");
  EXPECT_EQ(bus.capture, "can.pcap");
  EXPECT_EQ(bus.cpu, 1U);
  EXPECT_THAT(bus.devices.at(0).serial, ElementsAre(SerialConnection{"serial", "pty:/tmp/serial"}));
  const auto& drive = bus.devices[0].setup.as<devices::Tmcc160Configuration>();
  EXPECT_EQ(drive.node_id, 5);
  EXPECT_EQ(drive.bit_rate, 250);
  EXPECT_EQ(drive.boot_time, 0_ms);
  EXPECT_TRUE(drive.options.eds);
  EXPECT_EQ(drive.options.status_event_timer, 20);
  EXPECT_FALSE(drive.options.lss);
  EXPECT_EQ(drive.axis.load.inertia, 1e-4);
  EXPECT_EQ(rack.buses[1].name, "can1");
  EXPECT_FALSE(rack.buses[1].bit_rate);
}

TEST(BusSection, ADriveWithLssCanBeDeliveredWithoutANodeId) {
  for (const char* keys : {"lss = true\n", "friendly = true\n"}) {
    const RackConfiguration rack =
        parse(kOneDrive + std::string("node_id = 255\nmaps_as_maker_eds = true\n") + keys);
    const auto& drive = rack.buses.at(0).devices.at(0).setup.as<devices::Tmcc160Configuration>();
    EXPECT_EQ(drive.node_id, 255);
    EXPECT_TRUE(drive.options.maps_as_maker_eds);
  }
  EXPECT_THAT(refusal_of(kOneDrive + std::string("node_id = 255\n")),
              HasSubstr("nothing could give it one; set \"lss\" or \"friendly\" to true too"));
  EXPECT_THAT(refusal_of(kOneDrive + std::string("friendly = true\nlss = false\nnode_id = 255\n")),
              HasSubstr("nothing could give it one"));
  EXPECT_THAT(refusal_of(kOneDrive + std::string("lss = true\nnode_id = 128\n")),
              HasSubstr("\"node_id\" is 128; a node-ID is 1 to 127"));
}

TEST(BusSection, MistakesAreExplained) {
  EXPECT_THAT(refusal_of("[[bus]]\n"), HasSubstr("needs at least one [[bus.device]]"));
  EXPECT_THAT(refusal_of("clock = \"real\"\n"), HasSubstr("[[segment]], [[bus]] or [[device]]"));
  const auto with = [](const std::string& keys) {
    return refusal_of("[[bus]]\n" + keys + "[[bus.device]]\ntype = \"tmcc160\"\n");
  };
  EXPECT_THAT(with("bit_rate = 2000\n"), HasSubstr("bit_rate"));
  EXPECT_THAT(with("bit_rate = \"fast\"\n"), HasSubstr("unlimited"));
  EXPECT_THAT(with("ports = [\"slcn:/tmp/can\"]\n"), HasSubstr("slcan:PATH"));
  EXPECT_THAT(refusal_of(kOneDrive + std::string("bit_rate = 333\n")),
              HasSubstr("the drive knows 20, 50, 100"));
  EXPECT_THAT(with("name = \"tmcc160\"\n"), HasSubstr("is given twice"));
  EXPECT_THAT(refusal_of("[[bus]]\n[[bus.device]]\ntype = \"tmcm-3315\"\n"), HasSubstr("tmcc160"))
      << "an EtherCAT device";
  EXPECT_THAT(refusal_of("[[segment]]\n[[segment.device]]\ntype = \"tmcc160\"\n"),
              HasSubstr("tmcm-3315"))
      << "a CAN device";
}

TEST(BusSection, EventsOfABus) {
  const RackConfiguration rack = parse(std::string(kOneDrive) + R"(
[[event]]
at = "1s"
action = "break"
device = "lift"
[[event]]
at = "2s"
action = "bus-off"
device = "lift"
[[event]]
at = "3s"
action = "error-passive"
device = "lift"
[[event]]
at = "4s"
action = "drop"
device = "lift"
[[event]]
at = "5s"
action = "corrupt"
bus = "can0"
frames = 3
identifier = 0x601
[[event]]
at = "6s"
action = "delay"
bus = "can0"
delay = "2ms"
)");
  ASSERT_EQ(rack.events.size(), 6U);
  const DeviceAddress lift{0, 0, NetworkKind::bus};
  EXPECT_EQ(std::get<CableEvent>(rack.events[0].event).device, lift);
  EXPECT_EQ(std::get<ErrorStateEvent>(rack.events[1].event).state, can::ErrorState::bus_off);
  EXPECT_EQ(std::get<ErrorStateEvent>(rack.events[2].event).state, can::ErrorState::error_passive);
  const auto& drop = std::get<FrameFaultEvent>(rack.events[3].event);
  EXPECT_EQ(drop.device, 0U);
  EXPECT_EQ(drop.fault.kind, can::FrameFaultKind::drop);
  EXPECT_EQ(drop.fault.frames, 1U);
  const auto& corrupt = std::get<FrameFaultEvent>(rack.events[4].event);
  EXPECT_FALSE(corrupt.device);
  EXPECT_EQ(corrupt.fault.frames, 3U);
  EXPECT_EQ(corrupt.fault.identifier, 0x601U);
  EXPECT_EQ(std::get<FrameFaultEvent>(rack.events[5].event).fault.delay, 2_ms);
}

TEST(BusSection, MistakesOfEventsAreExplained) {
  EXPECT_THAT(refusal_of_event("action = \"drop\"\n"), HasSubstr("\"device\" is missing"));
  EXPECT_THAT(refusal_of_event("action = \"drop\"\nbus = \"can7\"\n"),
              HasSubstr("the buses are: can0"));
  EXPECT_THAT(refusal_of_event("action = \"delay\"\nbus = \"can0\"\n"),
              HasSubstr("\"delay\" is missing"));
  EXPECT_THAT(refusal_of_event("action = \"break\"\ndevice = \"lift\"\nport = 1\n"),
              HasSubstr("unknown key \"port\""));
  EXPECT_THAT(refusal_of("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n[[event]]\nat = "
                         "\"1s\"\naction = \"bus-off\"\ndevice = \"tmcm-3315\"\n"),
              HasSubstr("is on no CAN bus"));
}

}  // namespace
}  // namespace stator::rack
