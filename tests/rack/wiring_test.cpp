// How a rack file wires devices, and what a frame makes of it.

#include "stator/rack/core/wiring.hpp"

#include <array>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/base/byte_order.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ethercat::MasterInterface;
using ::testing::HasSubstr;

std::string device(const std::string& name, const std::string& keys = "") {
  return "[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"" + name + "\"\n" + keys + "\n";
}

RackConfiguration parse(const std::string& devices, const std::string& segment_keys = "") {
  return parse_rack_file("[[segment]]\n" + segment_keys + "\n" + devices, "test.toml",
                         devices::products());
}

std::string refusal_of(const std::string& devices, const std::string& segment_keys = "") {
  try {
    (void)parse(devices, segment_keys);
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

/// Where a broadcast read that enters at `entry` comes out, and how many slaves counted.
struct Passage {
  std::optional<MasterInterface> exit;
  unsigned working_counter = 0;
};
Passage pass(Rack& rack, MasterInterface entry = MasterInterface::primary,
             base::SimTime arrival = {}) {
  std::array<std::byte, 64> buffer{};
  ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
  builder.append(ethercat::Command::brd, 0, 0, std::size_t{1});
  const std::span<std::byte> frame = builder.finish();
  Passage passage{rack.process_frame(0, frame, arrival, entry)};
  passage.working_counter = std::to_integer<unsigned>(frame[frame.size() - 2]);
  return passage;
}

TEST(Wiring, DevicesThatSayNothing_HangInLine) {
  const RackConfiguration rack = parse(device("a") + device("b") + device("c"));
  const auto& devices = rack.segments[0].devices;
  EXPECT_FALSE(attachment_of(devices, 0).parent.has_value());
  EXPECT_EQ(attachment_of(devices, 2).parent, 1U);
  EXPECT_EQ(attachment_of(devices, 2).parent_port, 1U);
  EXPECT_EQ(attachment_of(devices, 2).port, 0U);
  EXPECT_EQ(devices[2].wiring.cable_delay, 10_ns);
}

TEST(Wiring, KeysArriveWhereTheyBelong) {
  const RackConfiguration rack = parse(
      device("a", "entry_port = 1") +
      device("b", "after = \"a\"\nport = 0\ncable_delay = \"55ns\"\nforwarding_delay = \"1us\""));
  const auto& devices = rack.segments[0].devices;
  EXPECT_EQ(attachment_of(devices, 0).port, 1U);
  EXPECT_EQ(attachment_of(devices, 1).parent_port, 0U);
  EXPECT_EQ(devices[1].wiring.cable_delay, 55_ns);
  EXPECT_EQ(devices[1].forwarding_delay, 1_us);
}

TEST(Wiring, DeviceWiredTheWrongWayRound_LeadsOnThroughItsPortZero) {
  const RackConfiguration configuration =
      parse(device("a") + device("b", "entry_port = 1") + device("c"));
  EXPECT_EQ(attachment_of(configuration.segments[0].devices, 2).parent_port, 0U);
  EventLog log;
  Rack rack(configuration, log);
  EXPECT_EQ(pass(rack).working_counter, 3U);
}

TEST(Wiring, MistakesAreExplained) {
  const std::string a = device("a");
  const std::string b = device("b");
  EXPECT_THAT(refusal_of(a + device("b", "after = \"c\"")),
              HasSubstr("it must name a device above this one in the same segment: a"));
  EXPECT_THAT(refusal_of(a + device("b", "after = \"b\"")), HasSubstr("\"after\" is \"b\""));
  EXPECT_THAT(refusal_of(a + b + device("c", "after = \"a\"")),
              HasSubstr("\"b\" hangs at port 1 of \"a\" already"));
  EXPECT_THAT(refusal_of(a + device("b", "port = 0")),
              HasSubstr("port 0 of \"a\" leads to the master"));
  EXPECT_THAT(refusal_of(a + device("b", "port = 2")),
              HasSubstr("\"port\" is 2, but \"a\" has the ports 0 to 1"));
  EXPECT_THAT(refusal_of(device("a", "entry_port = 3")),
              HasSubstr("\"entry_port\" is 3, but \"a\" has the ports 0 to 1"));
  EXPECT_THAT(refusal_of(device("a", "port = 1")), HasSubstr("\"entry_port\""));
  EXPECT_THAT(refusal_of(a, "redundant = \"eth1\""), HasSubstr("write ethercat:INTERFACE"));
  EXPECT_THAT(refusal_of(a, "link = \"ethercat:x\"\nredundant = \"ethercat:x\""),
              HasSubstr("a ring needs two"));
  EXPECT_EQ(refusal_of(a + b), "accepted");
}

TEST(Wiring, RedundantLink_ClosesTheRingOnceItHasACarrier) {
  EventLog log;
  Rack rack(parse(device("a") + device("b"), "redundant = \"ethercat:eth9\""), log);
  EXPECT_EQ(pass(rack).exit, MasterInterface::primary) << "not plugged yet";
  rack.set_carrier(0, MasterInterface::secondary, true, {});
  EXPECT_EQ(pass(rack).exit, MasterInterface::secondary);
  EXPECT_EQ(pass(rack, MasterInterface::secondary).exit, MasterInterface::primary);
  EXPECT_EQ(pass(rack, MasterInterface::secondary).working_counter, 0U);
  rack.set_carrier(0, MasterInterface::primary, false, {});
  EXPECT_EQ(pass(rack, MasterInterface::secondary).exit, MasterInterface::secondary);
  EXPECT_EQ(pass(rack, MasterInterface::secondary).working_counter, 2U);
  EXPECT_FALSE(pass(rack).exit.has_value());
  EXPECT_EQ(log.count("carrier-lost"), 1U);
  EXPECT_THAT(log.line(log.events().back()), HasSubstr("a: the primary network interface"));
}

TEST(Wiring, ForwardingAndCableDelays_ReachTheSegment) {
  EventLog log;
  Rack slow(parse(device("a") + device("b", "cable_delay = \"500ns\"\nforwarding_delay = \"2us\"")),
            log);
  std::array<std::byte, 64> buffer{};
  ethercat::FrameBuilder latch(buffer, {2, 0, 0, 0, 0, 1});
  latch.append(ethercat::Command::bwr, 0, 0x09000000, std::size_t{4});
  ASSERT_TRUE(slow.process_frame(0, latch.finish(), base::SimTime(1_ms)));
  std::array<std::byte, 8> times{};
  slow.slave({}).controller().peek(0x0900, times);
  const auto port0 = base::load_le<std::uint32_t>(times.data());
  const auto port1 = base::load_le<std::uint32_t>(times.data() + 4);
  EXPECT_EQ(port1 - port0, 300U + 2 * 500U + 2000U);
}

}  // namespace
}  // namespace stator::rack
