// When faults begin and end, and how they are asked for.

#include "stator/rack/faults/faults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/fault_bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/master/cia402/cia402_client.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ethercat::Command;
using ::testing::HasSubstr;
using tests::BusFaultBench;
using tests::kTwoModules;
using tests::SegmentFaultBench;

constexpr const char* kDropForTenMilliseconds = R"(
[[fault]]
kind = "ethercat-drop"
name = "cut"
device = "right"
for = "10ms"
)";

bool returns(SegmentFaultBench& bench) {
  return bench.send(Command::brd, 0, 0x0130).has_value();
}

std::string with(const std::string& faults) {
  return kTwoModules + faults;
}

TEST(Faults, AtOnce_BeginWithTheRackAndEndAfterTheirTime) {
  SegmentFaultBench bench(with(kDropForTenMilliseconds));
  EXPECT_FALSE(returns(bench));
  EXPECT_EQ(bench.state(1), FaultState::active);
  EXPECT_EQ(bench.status(1).remaining, "9.95 ms");
  bench.port.wait(base::SimTime(10_ms) - bench.now());
  EXPECT_TRUE(returns(bench));
  EXPECT_EQ(bench.state(1), FaultState::done);
  EXPECT_EQ(bench.status(1).ended, base::SimTime(10_ms));
  EXPECT_EQ(bench.log.count("fault-begins"), 1U);
  EXPECT_EQ(bench.log.count("fault-ends"), 1U);
}

TEST(Faults, AtATime_BeginToTheNanosecondAlsoWhenNobodyAdvancesTheRack) {
  SegmentFaultBench bench(with("[[fault]]\nkind = 'power-off'\ndevice = 'left'\nat = '5ms'\n"));
  std::array<std::byte, 64> buffer{};
  const auto passes = [&](base::SimDuration at) {
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(Command::brd, 0, 0, std::size_t{1});
    return bench.rack.process_frame(0, builder.finish(), base::SimTime(at)).has_value();
  };
  EXPECT_TRUE(passes(4'999'999_ns));
  EXPECT_FALSE(passes(5_ms));
  EXPECT_EQ(bench.log.events().back().time, base::SimTime(5_ms));
}

TEST(Faults, AfterAnother_BeginWhenThatHasEndedAndTheirWaitIsOver) {
  SegmentFaultBench bench(with(std::string(kDropForTenMilliseconds) + R"(
[[fault]]
kind = "power-off"
device = "right"
after = "cut"
wait = "5ms"
for = "20ms"
)"));
  EXPECT_EQ(bench.status(2).remaining, "waits for the end of cut");
  bench.port.wait(14_ms);
  EXPECT_EQ(bench.state(2), FaultState::armed);
  bench.port.wait(2_ms);
  EXPECT_EQ(bench.state(2), FaultState::active);
  EXPECT_EQ(bench.status(2).begun, base::SimTime(15_ms));
  bench.port.wait(20_ms);
  EXPECT_EQ(bench.status(2).ended, base::SimTime(35_ms));
}

TEST(Faults, AfterHealthyCycles_CountThoseInARowOnly) {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault =
      bench.inject("kind = 'power-off'\ndevice = 'right'\nfor = '1ms'\nwhen.cycles = 5");
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(bench.master.exchange_process_data());
  }
  EXPECT_EQ(bench.state(fault), FaultState::armed);
  bench.inject("kind = 'ethercat-drop'\ndevice = 'left'\ncount = 1");
  static_cast<void>(bench.master.exchange_process_data());  // lost, and perhaps sent again
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(bench.master.exchange_process_data());
    EXPECT_EQ(bench.state(fault), FaultState::armed) << i;
  }
  ASSERT_TRUE(bench.master.exchange_process_data());
  ASSERT_TRUE(bench.master.exchange_process_data());
  EXPECT_EQ(bench.state(fault), FaultState::active);
}

TEST(Faults, AtAnSdo_HitThatVeryRequest) {
  SegmentFaultBench bench;
  ASSERT_EQ(bench.scan(), 2U);
  ASSERT_TRUE(bench.master.start_mailbox(1));
  const auto fault = bench.inject(
      "kind = 'mailbox-abort'\ndevice = 'right'\ncount = 1\nwhen = { sdo = '1018:02', count = 2 }");
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 2}));
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 1}));
  EXPECT_EQ(bench.state(fault), FaultState::armed);
  EXPECT_FALSE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 2})) << "the second time";
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 2}));
  EXPECT_EQ(bench.state(fault), FaultState::done);
}

TEST(Faults, AtAMailboxMessage_CountAllRequests) {
  SegmentFaultBench bench;
  ASSERT_EQ(bench.scan(), 2U);
  ASSERT_TRUE(bench.master.start_mailbox(1));
  bench.inject("kind = 'mailbox-abort'\ndevice = 'right'\ncount = 1\nwhen.message = 3");
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 1}));
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 2}));
  EXPECT_FALSE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 3}));
  EXPECT_TRUE(bench.master.upload_number<std::uint32_t>(1, {0x1018, 3}));
}

TEST(Faults, AtANetworkStateAndAPowerState_BeginWhenItIsReached) {
  SegmentFaultBench bench(with(R"(
[[fault]]
kind = "set"
device = "left"
input = "input0"
value = 1
when.network_state = "safe-operational"
[[fault]]
kind = "set"
device = "left"
input = "input1"
value = 1
when = { power_state = "operation-enabled", axis = 1, device = "right" }
)"));
  ASSERT_EQ(bench.scan(), 2U);
  EXPECT_EQ(bench.signal("left.input0"), 0.0);
  bench.bring_to_operational();
  EXPECT_EQ(bench.signal("left.input0"), 1.0);
  master::Cia402Client other(bench.master, 1, 0);
  ASSERT_TRUE(other.set_mode(master::OperationMode::profile_position));
  ASSERT_TRUE(other.enable());
  EXPECT_EQ(bench.signal("left.input1"), 0.0);
  master::Cia402Client axis(bench.master, 1, 1);
  ASSERT_TRUE(axis.set_mode(master::OperationMode::profile_position));
  ASSERT_TRUE(axis.enable());
  EXPECT_EQ(bench.signal("left.input1"), 1.0);
}

TEST(Faults, AtAPosition_BeginWhenTheAxisPassesIt) {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault = bench.inject(
      "kind = 'set'\ndevice = 'left'\ninput = 'input0'\nvalue = 1\n"
      "when.position = 20000");
  master::Cia402Client axis(bench.master, 0, 0);
  ASSERT_TRUE(axis.set_mode(master::OperationMode::profile_position));
  ASSERT_TRUE(axis.enable());
  ASSERT_TRUE(axis.start_move(
      {.target = 10'000, .velocity = 256'000, .acceleration = 512'000, .deceleration = 512'000}));
  ASSERT_TRUE(axis.wait_for_target(5_s));
  EXPECT_EQ(bench.state(fault), FaultState::armed);
  ASSERT_TRUE(axis.start_move(
      {.target = 30'000, .velocity = 256'000, .acceleration = 512'000, .deceleration = 512'000}));
  ASSERT_TRUE(axis.wait_for_target(5_s));
  EXPECT_EQ(bench.state(fault), FaultState::active) << "an input that is set stays so";
  EXPECT_EQ(bench.signal("left.input0"), 1.0);
}

TEST(Faults, AtACanFrame_CountThoseWithItsIdentifier) {
  BusFaultBench bench(500'000);
  bench.inject("kind = 'can-drop'\ndevice = 'b'\ncount = 1\nwhen = { frame = 0x602, count = 2 }");
  EXPECT_EQ(bench.ask(0x602).size(), 1U);
  EXPECT_EQ(bench.ask(0x601).size(), 1U);
  EXPECT_EQ(bench.ask(0x602).size(), 0U) << "armed by the request, it takes the answer";
  EXPECT_EQ(bench.ask(0x602).size(), 1U);
}

TEST(Faults, OfALine_AreToldOfADeviceThatIsAtIt) {
  tests::LineFaultBench bench;
  const auto fault =
      bench.inject("kind = 'serial-cut'\nline = 'pty:field'\nbytes = 4\nfor = '90s'");
  EXPECT_EQ(bench.log.line(bench.log.events().back()), "a: fault 1 begins: serial-cut");
  EXPECT_EQ(bench.status(fault).remaining, "90.0 s");
}

TEST(Faults, Clear_EndsWhatIsActiveAndTakesBackWhatWaits) {
  SegmentFaultBench bench;
  const auto active = bench.inject("kind = 'power-off'\ndevice = 'right'");
  const auto waits = bench.inject("kind = 'power-off'\ndevice = 'left'\nat = '1s'");
  EXPECT_EQ(bench.status(active).remaining, "until it is cleared");
  EXPECT_EQ(bench.scan(), 1U);
  EXPECT_EQ(bench.rack.clear_faults(std::nullopt, bench.now()), 2U);
  EXPECT_EQ(bench.state(active), FaultState::done);
  EXPECT_EQ(bench.state(waits), FaultState::done);
  bench.port.wait(2_s);
  EXPECT_EQ(bench.scan(), 2U);
  EXPECT_EQ(bench.rack.clear_faults(99, bench.now()), 0U);
}

TEST(Faults, ClearAll_LetsNothingBeginThatComesAfter) {
  SegmentFaultBench bench(with(R"(
[[fault]]
kind = "ethercat-drop"
name = "cut"
device = "right"
[[fault]]
kind = "power-off"
device = "right"
after = "cut"
)"));
  bench.rack.clear_faults(std::nullopt, bench.now());
  bench.port.wait(1_ms);
  EXPECT_EQ(bench.scan(), 2U);
  EXPECT_EQ(bench.log.count("power-off"), 0U);
}

std::string lost_frames(std::uint64_t seed) {
  SegmentFaultBench bench;
  const auto fault =
      bench.inject("kind = 'ethercat-drop'\ndevice = 'right'\nprobability = 0.3\nseed = " +
                   std::to_string(seed));
  std::string lost;
  for (int i = 0; i < 200; ++i) {
    lost += returns(bench) ? '.' : 'x';
  }
  EXPECT_EQ(bench.status(fault).hits, static_cast<std::uint64_t>(std::ranges::count(lost, 'x')));
  return lost;
}

TEST(Faults, Probability_HitsTheSameFramesWithTheSameSeed) {
  const std::string first = lost_frames(7);
  EXPECT_EQ(first, lost_frames(7));
  EXPECT_NE(first, lost_frames(8));
  EXPECT_GT(std::ranges::count(first, 'x'), 30);
  EXPECT_LT(std::ranges::count(first, 'x'), 90);
}

/// A load that a program thought of.
class OwnEffect final : public FaultEffect {
 public:
  OwnEffect(faults::Target& target, DeviceAddress device)
      : target_(target), load_{device, "axis0.load_torque", 0.02, false} {}
  void begin(base::SimTime now) override { target_.hold(load_, this, now); }
  void end(base::SimTime now) override { target_.release(load_, this, now); }

 private:
  faults::Target& target_;
  InputEvent load_;
};

TEST(Faults, OfAKindOfAProgramsOwnAreLikeAllOthers) {
  constexpr FaultKind kOwn{
      .name = "own-load",
      .make = [](const FaultSite& site, const FaultConfiguration& fault) -> MadeEffect {
        return std::make_unique<OwnEffect>(site.target, *fault.target.device);
      },
      .scope = FaultScope::device,
      .summary = "a load",
      .effect = "none"};
  SegmentFaultBench bench;
  const DeviceAddress left{0, 0, NetworkKind::segment};
  const auto fault = bench.rack.inject({.kind = &kOwn, .target = {.device = left}}, bench.now());
  ASSERT_TRUE(fault) << fault.error();
  EXPECT_EQ(bench.state(*fault), FaultState::active);
  EXPECT_EQ(bench.rack.input_value({left, "axis0.load_torque"}), 0.02);
  bench.clear(*fault);
  EXPECT_EQ(bench.rack.input_value({left, "axis0.load_torque"}), 0.0);
}

TEST(Faults, WithoutAny_NothingIsDueAndNobodyIsWatched) {
  SegmentFaultBench bench;
  EXPECT_EQ(bench.rack.next_bus_deadline(), base::SimTime::never());
  const auto fault = bench.inject("kind = 'ethercat-drop'\ndevice = 'right'\ncount = 1");
  EXPECT_FALSE(returns(bench));
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_EQ(bench.rack.next_bus_deadline(), base::SimTime::never());
}

std::string refusal_of(const std::string& fault) {
  return tests::refusal_of_rack(kTwoModules + ("[[fault]]\n" + fault));
}

TEST(FaultSection, MistakesAreExplained) {
  EXPECT_THAT(refusal_of("device = 'left'\n"), HasSubstr("\"kind\" is missing"));
  EXPECT_THAT(refusal_of("kind = 'ethercat-dorp'\ndevice = 'left'\n"),
              HasSubstr("did you mean \"ethercat-drop\"?"));
  EXPECT_THAT(refusal_of("kind = 'ethercat-drop'\n"), HasSubstr("\"device\" is missing"));
  EXPECT_THAT(refusal_of("kind = 'ethercat-drop'\ndevice = 'right'\nport = 1\n"),
              HasSubstr("port 1 of \"right\" has no cable"));
  EXPECT_THAT(refusal_of("kind = 'ethercat-delay'\ndevice = 'right'\n"),
              HasSubstr("\"delay\" is missing"));
  EXPECT_THAT(refusal_of("kind = 'can-drop'\ndevice = 'right'\n"), HasSubstr("is on no CAN bus"));
  EXPECT_THAT(refusal_of("kind = 'serial-cut'\ndevice = 'right'\n"),
              HasSubstr("is on no serial line"));
  EXPECT_THAT(refusal_of("kind = 'fall-back'\ndevice = 'right'\nfor = '1s'\n"),
              HasSubstr("is over as soon as it has begun"));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\ncount = 2\n"),
              HasSubstr("nothing to count"));
  EXPECT_THAT(refusal_of("kind = 'mailbox-stall'\ndevice = 'right'\nmode = 'full'\ncount = 2\n"),
              HasSubstr("end it with \"for\""));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\nat = '1s'\nwhen.cycles = 3\n"),
              HasSubstr("give one of them"));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\nafter = 'other'\n"),
              HasSubstr("there is no fault \"other\""));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\nwhen.frame = 3\n"),
              HasSubstr("on a CAN bus only"));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\nwhen.axis = 1\n"),
              HasSubstr("a milestone is one of"));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\nwhen.sdo = 'mode'\n"),
              HasSubstr("write index or index:subindex"));
  EXPECT_THAT(refusal_of("kind = 'working-counter'\ndevice = 'right'\ncommands = 'LRX'\n"),
              HasSubstr("\"LRX\" is no EtherCAT command"));
  EXPECT_THAT(refusal_of("kind = 'set'\ndevice = 'left'\ninput = 'axis0.load_torqe'\nvalue = 1\n"),
              HasSubstr("did you mean \"axis0.load_torque\"?"));
  EXPECT_THAT(refusal_of("kind = 'power-off'\ndevice = 'right'\nduration = '1s'\n"),
              HasSubstr("unknown key \"duration\""));
}

TEST(FaultSection, WhatIsAskedForWhileARackRunsHasNoPlaceInAFile) {
  const RackConfiguration rack = parse_rack_file(kTwoModules, "test.toml", devices::products());
  try {
    (void)parse_fault("kind = 'ethercat-drop'\ndevice = 'middle'", rack);
    FAIL() << "accepted";
  } catch (const RackFileError& error) {
    EXPECT_STREQ(error.what(), "\"device\" is \"middle\"; the devices are: left, right");
  }
}

TEST(FaultSection, ASignalThatDoesNotExistIsRefusedWhenTheRackIsBuilt) {
  SegmentFaultBench bench;
  const auto refused = bench.rack.inject(
      parse_fault("kind = 'power-off'\ndevice = 'left'\nwhen = { signal = 'axis9.x', value = 1 }",
                  bench.configuration),
      bench.now());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error(), "left has no signal \"axis9.x\" to wait for");
}

TEST(FaultsOfATmc8670, AMarkedFrameIsCountedAsForwardedErrorBehindTheFirstThatSawIt) {
  SegmentFaultBench bench(
      "[[segment]]\n"
      "[[segment.device]]\ntype = 'tmc8670'\nname = 'left'\n"
      "[[segment.device]]\ntype = 'tmc8670'\nname = 'right'\n");
  namespace address = ethercat::register_address;
  EXPECT_NE(bench.read(0, address::kFeatures) & 0x80U, 0U) << "counts them separately";
  bench.inject("kind = 'ethercat-corrupt'\ndevice = 'left'\ncount = 1");
  EXPECT_FALSE(bench.send(ethercat::Command::bwr, 0, 0x1F00, 1, 1_ms));
  EXPECT_EQ(bench.counter(0, address::kReceiveErrors), 1U) << "its check sequence is wrong";
  EXPECT_EQ(bench.counter(0, address::kForwardedErrors), 0U);
  EXPECT_EQ(bench.counter(1, address::kReceiveErrors), 0U);
  EXPECT_EQ(bench.counter(1, address::kForwardedErrors), 1U) << "the first has marked it";
}

}  // namespace
}  // namespace stator::rack
