// Cables and power by the timetable of a rack file.

#include "stator/rack/world/timetable.hpp"

#include <array>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/rack_bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/master/cia402/cia402_client.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;

using tests::kTwoModules;

RackConfiguration two_modules(const std::string& events) {
  return parse_rack_file(kTwoModules + events, "test.toml", devices::products());
}

std::string refusal_of(const std::string& events) {
  return tests::refusal_of_rack(kTwoModules + events);
}

class Bench : public tests::SegmentBench {
 public:
  explicit Bench(const std::string& events) : SegmentBench(kTwoModules + events) {}

  [[nodiscard]] const ethercat::SegmentStatistics& statistics() const {
    return rack.segment(0).statistics();
  }
};

TEST(Timetable, GivesEventsInTheOrderOfTime) {
  Timetable timetable({{3_s, PowerEvent{{0, 3}, false}},
                       {1_s, PowerEvent{{0, 1}, false}},
                       {1_s, PowerEvent{{0, 2}, false}}});
  EXPECT_EQ(timetable.next(), base::SimTime(1_s));
  EXPECT_EQ(std::get<PowerEvent>(timetable.take()).device.device, 1U);
  EXPECT_EQ(std::get<PowerEvent>(timetable.take()).device.device, 2U) << "as written in the file";
  EXPECT_EQ(timetable.next(), base::SimTime(3_s));
  (void)timetable.take();
  EXPECT_EQ(timetable.next(), base::SimTime::never());
}

TEST(Events, BreakAndHeal_HappenAtTheirTimeAndAreLogged) {
  Bench bench(R"(
[[event]]
at = "2 s"
action = "heal"
device = "right"
[[event]]
at = "1 s"
action = "break"
device = "left"
port = 1
)");
  EXPECT_EQ(bench.scan(), 2U);
  bench.wait_until(1_s);
  EXPECT_EQ(bench.scan(), 1U);
  EXPECT_EQ(bench.log.count("cable-broken"), 1U);
  EXPECT_THAT(bench.log.line(bench.log.events().back()), ::testing::StartsWith("left: "));
  EXPECT_EQ(bench.log.count("cable-healed"), 0U);
  bench.wait_until(2_s);
  EXPECT_EQ(bench.scan(), 2U) << "both events act on the same cable";
}

TEST(Events, DroppedAndCorruptFramesOfASegment_AreMissedAndCounted) {
  Bench bench(R"(
[[event]]
at = "4 s"
action = "drop"
device = "left"
frames = 1
[[event]]
at = "8 s"
action = "corrupt"
device = "left"
port = 1
direction = "out"
)");
  bench.wait_until(3_s);
  EXPECT_EQ(bench.scan(), 2U);
  bench.wait_until(4_s);
  EXPECT_EQ(bench.scan(), 2U) << "the master repeats what got lost";
  EXPECT_EQ(bench.statistics().dropped, 1U);
  bench.wait_until(8_s);
  EXPECT_EQ(bench.scan(), 2U);
  EXPECT_EQ(bench.statistics().corrupted, 1U);
  EXPECT_EQ(bench.log.count("ethercat-frame-fault"), 2U);
  EXPECT_THAT(bench.log.line(bench.log.events().back()),
              HasSubstr("destruction of the next 1 frames that leave port 1"));
}

TEST(Events, AFrameLostOnItsWayBackHasBroughtItsRequestsToTheFirmware) {
  Bench bench(R"(
[[event]]
at = "4 s"
action = "drop"
device = "left"
direction = "out"
)");
  bench.wait_until(3_s);
  ASSERT_EQ(bench.scan(), 2U);
  bench.wait_until(4_s);
  std::array<std::byte, 64> buffer{};
  std::array<std::byte, 64> reply{};
  const auto exchange = [&](ethercat::Command command, std::uint16_t address, std::uint8_t value) {
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    const std::array<std::byte, 1> data{std::byte{value}};
    builder.append(command, 0, ethercat::physical_address(0, address),
                   std::span<const std::byte>(data));
    const auto length = bench.port.exchange(builder.finish(), reply, 0_ns);
    EXPECT_TRUE(length);
    return *length;
  };
  constexpr std::uint8_t kOperational = 8;  // which is refused in Init
  EXPECT_EQ(exchange(ethercat::Command::bwr, 0x0120, kOperational), 0U);
  EXPECT_EQ(bench.statistics().dropped, 1U);
  const std::size_t length = exchange(ethercat::Command::aprd, 0x0130, 0);
  const auto datagram = ethercat::DatagramCursor(std::span(reply).first(length)).next();
  ASSERT_TRUE(datagram);
  EXPECT_EQ(std::to_integer<unsigned>(datagram->bytes()[0]), 0x11U) << "before its next tick";
}

TEST(Events, AreInForceForTheFirstFrameThatComesAfterThem) {
  const RackConfiguration configuration = two_modules(R"(
[[event]]
at = "5ms"
action = "break"
device = "left"
)");
  EventLog log;
  Rack rack(configuration, log);
  const auto returns = [&rack](base::SimDuration at) {
    std::array<std::byte, 64> buffer{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(ethercat::Command::brd, 0, 0, std::size_t{1});
    return rack.process_frame(0, builder.finish(), base::SimTime(at)).has_value();
  };
  EXPECT_TRUE(returns(4'999_us));
  EXPECT_FALSE(returns(5_ms)) << "also when nobody called advance()";
  EXPECT_EQ(log.events().back().time, base::SimTime(5_ms));
}

TEST(Events, PowerOffAndOn_StartTheDeviceAnew) {
  Bench bench(R"(
[[event]]
at = "5s"
action = "power-off"
device = "right"
[[event]]
at = "6s"
action = "power-on"
device = "right"
)");
  bench.bring_to_operational();
  master::Cia402Client client(bench.master, 1, 0);
  ASSERT_TRUE(client.set_mode(master::OperationMode::profile_velocity));
  ASSERT_TRUE(client.enable());
  while (bench.port.now() < base::SimTime(4'900_ms)) {
    ASSERT_TRUE(bench.master.run_cycle());
  }
  const auto enabled = static_cast<unsigned>(bench.signal("right.axis0.statusword"));
  EXPECT_EQ(enabled & 0x6FU, 0x27U) << "operation enabled";

  bench.wait_until(5'500_ms);
  const auto off = static_cast<unsigned>(bench.signal("right.axis0.statusword"));
  EXPECT_NE(off & 0x6FU, 0x27U) << "no power, no current";
  EXPECT_EQ(bench.scan(), 1U);

  bench.wait_until(7_s);
  EXPECT_EQ(bench.scan(), 2U);
  bench.bring_to_operational();
  master::Cia402Client again(bench.master, 1, 0);
  EXPECT_TRUE(again.enable());
  EXPECT_EQ(bench.log.count("power-off"), 1U);
  EXPECT_EQ(bench.log.count("power-on"), 1U);
}

TEST(Events, Set_ChangesAnInputAtItsTimeAndIsLogged) {
  Bench bench(R"(
[[event]]
at = "10ms"
action = "set"
device = "right"
input = "input2"
value = 1
[[event]]
at = "20ms"
action = "set"
device = "right"
input = "axis1.load_torque"
value = -0.25
)");
  bench.wait_until(9_ms);
  EXPECT_EQ(bench.signal("right.input2"), 0.0);
  bench.wait_until(10_ms);
  EXPECT_EQ(bench.signal("right.input2"), 1.0);
  EXPECT_EQ(bench.signal("left.input2"), 0.0);
  bench.wait_until(21_ms);
  EXPECT_EQ(bench.signal("right.axis1.load_torque"), -0.25);
  EXPECT_EQ(bench.log.count("input-set"), 2U);
  EXPECT_THAT(bench.log.line(bench.log.events().back()),
              ::testing::EndsWith("axis1.load_torque is set to -0.250 Nm"));
}

TEST(Events, Set_WithFromAndOver_IsARamp) {
  Bench bench(R"(
[[event]]
at = "100ms"
action = "set"
device = "left"
input = "axis0.supply_voltage"
from = 24
value = 14
over = "100ms"
)");
  bench.wait_until(150_ms);
  EXPECT_NEAR(bench.signal("left.axis0.supply_voltage"), 19.0, 0.2);
  bench.wait_until(201_ms);
  EXPECT_EQ(bench.signal("left.axis0.supply_voltage"), 14.0);
  EXPECT_EQ(bench.log.count("input-set"), 2U) << "begin and end";
}

TEST(Events, Set_OfWhatDoesNotExist_IsRefusedWhenTheRackIsBuilt) {
  RackConfiguration configuration = two_modules("");
  configuration.events.push_back({1_s, InputEvent{{0, 1}, "input9", 1.0}});
  EventLog log;
  try {
    const Rack rack(configuration, log);
    FAIL() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("right: there is no input \"input9\" (did you mean"));
  }
}

TEST(Events, MistakesOfSetAreExplained) {
  const auto refusal = [](const std::string& rest) {
    return refusal_of("[[event]]\nat = \"1s\"\naction = \"set\"\ndevice = \"left\"\n" + rest);
  };
  EXPECT_THAT(refusal("value = 1\n"), HasSubstr("\"set\" needs \"input\""));
  EXPECT_THAT(refusal("input = \"input0\"\n"), HasSubstr("and \"value\""));
  EXPECT_THAT(refusal("input = \"axis0.load_torqe\"\nvalue = 1\n"),
              HasSubstr("did you mean \"axis0.load_torque\"?"));
  EXPECT_THAT(refusal("input = \"axis0.supply_voltage\"\nvalue = 240\n"),
              HasSubstr("axis0.supply_voltage is set to 240; it takes 0 to 100 V"));
  EXPECT_THAT(refusal("input = \"input0\"\nvalue = 1\nover = \"1s\"\n"),
              HasSubstr("a ramp needs both"));
  EXPECT_THAT(refusal("input = \"input0\"\nvalue = 1\nfrom = 2\nover = \"1s\"\n"),
              HasSubstr("input0 is set to 2; it takes 0 to 1"));
}

TEST(Events, MistakesAreExplained) {
  EXPECT_THAT(refusal_of("[[event]]\naction = \"break\"\ndevice = \"left\"\n"),
              HasSubstr("\"at\" is missing"));
  EXPECT_THAT(refusal_of("[[event]]\nat = \"1s\"\ndevice = \"left\"\n"),
              HasSubstr("\"action\" is missing; it must be one of"));
  EXPECT_THAT(refusal_of("[[event]]\nat = \"1s\"\naction = \"brake\"\ndevice = \"left\"\n"),
              HasSubstr("did you mean \"break\"?"));
  EXPECT_THAT(refusal_of("[[event]]\nat = \"1s\"\naction = \"break\"\n"),
              HasSubstr("\"device\" is missing"));
  EXPECT_THAT(refusal_of("[[event]]\nat = \"1s\"\naction = \"break\"\ndevice = \"rigth\"\n"),
              HasSubstr("did you mean \"right\"?"));
  EXPECT_THAT(
      refusal_of("[[event]]\nat = \"1s\"\naction = \"break\"\ndevice = \"right\"\nport = 1\n"),
      HasSubstr("port 1 of \"right\" has no cable"));
  EXPECT_THAT(
      refusal_of("[[event]]\nat = \"1s\"\naction = \"power-on\"\ndevice = \"right\"\nport = 1\n"),
      HasSubstr("unknown key \"port\""));
  EXPECT_THAT(
      refusal_of("[[event]]\nat = \"1s\"\naction = \"drop\"\ndevice = \"right\"\nport = 1\n"),
      HasSubstr("port 1 of \"right\" has no cable"));
  EXPECT_THAT(refusal_of("[[event]]\nat = \"1s\"\naction = \"delay\"\ndevice = \"right\"\n"),
              HasSubstr("is on EtherCAT, where frames can be hit by"));
  EXPECT_THAT(refusal_of("[[event]]\nat = \"1s\"\naction = \"drop\"\ndevice = \"right\"\n"
                         "direction = \"up\"\n"),
              HasSubstr("\"direction\""));
}

}  // namespace
}  // namespace stator::rack
