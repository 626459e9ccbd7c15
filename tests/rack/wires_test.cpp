// Wires from outputs of devices to inputs of others, from the rack file to what drives make of it.

#include "stator/rack/world/wires.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/rack_bench.hpp"
#include "stator/master/cia402/cia402_client.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;

const std::string kRack = std::string(tests::kTwoModules) + R"([[bus]]
[[bus.device]]
type = "tmcc160"
name = "spindle"
)";

/// A button at IN0 of "left", pressed after 10 ms.
constexpr const char* kButton = R"(
[[event]]
at = "10ms"
action = "set"
device = "left"
input = "input0"
value = 1
)";

std::string wire(const std::string& from, const std::string& to, const std::string& more = "") {
  return "[[wire]]\nfrom = \"" + from + "\"\nto = \"" + to + "\"\n" + more + "\n";
}

std::string refusal_of(const std::string& tables) {
  return tests::refusal_of_rack(kRack + tables);
}

class Bench : public tests::SegmentBench {
 public:
  explicit Bench(const std::string& tables) : SegmentBench(kRack + tables) {}

  void advance(base::SimDuration to) { rack.advance(base::SimTime(to)); }
};

TEST(Wires, CarryALevelAtTheInstantAtWhichItIsThere) {
  Bench bench(kButton + wire("left.input0", "right.input1"));
  bench.advance(9'999_us);
  EXPECT_EQ(bench.signal("right.input1"), 0.0);
  bench.advance(10_ms);
  EXPECT_EQ(bench.signal("right.input1"), 1.0);
}

TEST(Wires, InvertAndScaleWhatTheyCarry) {
  Bench bench(kButton + wire("left.input0", "right.input1", "inverted = true") +
              wire("left.input0", "right.analog_input2", "scale = 1000.0\noffset = 7") +
              wire("left.input0", "right.analog_input3", "low = 100\nhigh = 3000"));
  bench.advance(9_ms);
  EXPECT_EQ(bench.signal("right.input1"), 1.0) << "from power-on";
  EXPECT_EQ(bench.signal("right.analog_input2"), 7.0);
  EXPECT_EQ(bench.signal("right.analog_input3"), 100.0);
  bench.advance(11_ms);
  EXPECT_EQ(bench.signal("right.input1"), 0.0);
  EXPECT_EQ(bench.signal("right.analog_input2"), 1007.0);
  EXPECT_EQ(bench.signal("right.analog_input3"), 3000.0);
}

TEST(Wires, OfAChainEachTakesAPeriodWhateverTheirOrder) {
  const std::string first = wire("left.input0", "right.input0");
  const std::string second = wire("right.input0", "left.input1");
  for (const std::string& wires : {first + second, second + first}) {
    Bench bench(kButton + wires);
    bench.advance(10_ms);
    EXPECT_EQ(bench.signal("right.input0"), 1.0);
    EXPECT_EQ(bench.signal("left.input1"), 0.0);
    bench.advance(10_ms + kWirePeriod);
    EXPECT_EQ(bench.signal("left.input1"), 1.0);
  }
}

TEST(Wires, DelayWhatTheyCarry) {
  Bench bench(kButton + wire("left.input0", "right.input1", "delay = \"2ms\""));
  bench.advance(11'999_us);
  EXPECT_EQ(bench.signal("right.input1"), 0.0);
  bench.advance(12_ms);
  EXPECT_EQ(bench.signal("right.input1"), 1.0);
}

TEST(Wires, AnOutputOfADeviceTakesTheSupplyFromTheDriveOfAnother) {
  Bench bench(wire("left.output2", "right.axis0.supply_voltage", "low = 24\nhigh = 0") +
              wire("left.output2", "right.input3"));
  master::Master& master = bench.master;
  ASSERT_TRUE(master.scan());
  ASSERT_TRUE(master.configure_process_data());
  ASSERT_TRUE(master.go_operational());
  master::Cia402Client drive(master, 1, 0);
  ASSERT_TRUE(drive.enable());
  constexpr std::uint32_t kOutput2 = 1U << 18U;
  ASSERT_TRUE(master.download_number(0, {0x2703, 2}, kOutput2));
  ASSERT_TRUE(master.run_cycle());
  EXPECT_EQ(bench.signal("right.input3"), 0.0);
  EXPECT_EQ(*drive.state(), master::DriveState::operation_enabled);

  ASSERT_TRUE(master.download_number(0, {0x2703, 1}, kOutput2));
  for (int i = 0; i < 500; ++i) {
    ASSERT_TRUE(master.run_cycle());
  }
  EXPECT_EQ(bench.signal("left.output2"), 1.0);
  EXPECT_EQ(bench.signal("right.input3"), 1.0);
  EXPECT_NE(*drive.state(), master::DriveState::operation_enabled);
}

std::vector<double> run_in_steps_of(base::SimDuration step) {
  Bench bench(kButton + wire("left.input0", "right.axis0.supply_voltage", "low = 12\nhigh = 30") +
              wire("right.axis0.supply_voltage", "spindle.axis0.supply_voltage",
                   "scale = 0.9\ndelay = \"3ms\"") +
              wire("left.input0", "right.axis1.load_torque", "high = 0.4"));
  for (base::SimTime now{}; now < base::SimTime(40_ms);) {
    now = std::min(now + step, base::SimTime(40_ms));
    bench.rack.advance(now);
  }
  std::vector<double> values;
  for (const product::Signal& signal : bench.rack.signals()) {
    values.push_back(signal.read());
  }
  return values;
}

TEST(Wires, GiveTheSameBitsWhateverTheIntervalsAtWhichTheRackIsToldTheTime) {
  const std::vector<double> reference = run_in_steps_of(40_ms);
  EXPECT_EQ(run_in_steps_of(1_ms), reference);
  EXPECT_EQ(run_in_steps_of(37_us), reference);
}

TEST(WireSection, RefusesWhatIsNotThere) {
  EXPECT_THAT(refusal_of(wire("rihgt.input0", "left.input0")),
              HasSubstr("did you mean \"right\"?"));
  EXPECT_THAT(refusal_of(wire("left.ouput0", "right.input0")),
              HasSubstr("there is no signal \"ouput0\" (did you mean \"output0\"?)"));
  EXPECT_THAT(refusal_of(wire("left.output0", "right.axis0.left_swich")),
              HasSubstr("did you mean \"axis0.left_switch\"?"));
  EXPECT_THAT(refusal_of("[[wire]]\nfrom = \"left.output0\"\n"), HasSubstr("\"to\" is missing"));
  EXPECT_THAT(refusal_of(wire("left.output0", "right.input0", "colour = \"red\"")),
              HasSubstr("test.toml:16"));
}

TEST(WireSection, RefusesWhatCannotBe) {
  EXPECT_THAT(refusal_of(wire("left.output0", "right.input0", "high = 5")), HasSubstr("\"high\""));
  EXPECT_THAT(refusal_of(wire("left.output0", "right.input0", "delay = \"70us\"")),
              HasSubstr("multiple of 50us"));
  EXPECT_THAT(refusal_of(wire("left.output0", "right.input0", "scale = 2.0\nlow = 1")),
              HasSubstr("analog"));
  EXPECT_THAT(
      refusal_of(wire("left.output0", "right.input0") + wire("left.output1", "right.input0")),
      HasSubstr("an input has one wire"));
  EXPECT_THAT(refusal_of(kButton + wire("right.output0", "left.input0")),
              HasSubstr("a wire or events"));
}

TEST(WireSection, RefusesRings) {
  EXPECT_THAT(refusal_of(wire("left.input0", "left.input0")), HasSubstr("must not form a ring"));
  EXPECT_THAT(refusal_of(wire("left.input0", "right.input0") + wire("right.input0", "left.input0")),
              HasSubstr("must not form a ring"));
}

}  // namespace
}  // namespace stator::rack
