// What faults of a CAN bus and of its controllers do to a master, and that they recover.

#include <gmock/gmock.h>

#include "rack/fault_kind_effects.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using tests::BusFaultBench;
using tests::FaultyNode;

void can_drop() {
  BusFaultBench bench;
  const auto fault = bench.inject("kind = 'can-drop'\nbus = 'can0'\nidentifier = 0x582\ncount = 1");
  EXPECT_THAT(bench.ask(0x601), ElementsAre(0x581)) << "another identifier";
  EXPECT_THAT(bench.ask(0x602), IsEmpty());
  EXPECT_EQ(bench.bus().statistics().error_frames, 0U);
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_THAT(bench.ask(0x602), ElementsAre(0x582));
}

void can_error_frame() {
  BusFaultBench bench(500'000);
  const auto fault = bench.inject("kind = 'can-error-frame'\ndevice = 'b'\ncount = 3");
  EXPECT_THAT(bench.ask(0x602), ElementsAre(0x582)) << "sent again";
  EXPECT_EQ(bench.bus().statistics().error_frames, 3U);
  const std::size_t b = bench.rack.bus(0).member_of(1);
  EXPECT_EQ(bench.bus().errors(b).transmit(), 3U * 8U - 1U);
  EXPECT_EQ(bench.state(fault), FaultState::done);
  // Without end: bus-off.
  const auto endless = bench.inject("kind = 'can-error-frame'\ndevice = 'b'");
  EXPECT_THAT(bench.ask(0x602), IsEmpty());
  EXPECT_EQ(bench.bus().errors(b).state(), can::ErrorState::bus_off);
  bench.clear(endless);
  bench.port.wait(10_ms);
  static_cast<void>(bench.received());
  EXPECT_THAT(bench.ask(0x602), ElementsAre(0x582));
  // What a product tells of it: 8120h, error passive.
  FaultyNode node;
  const auto of_node = node.inject("kind = 'can-error-frame'\ndevice = 'drive'\ncount = 17");
  EXPECT_TRUE(node.answers());
  EXPECT_EQ(node.state(of_node), FaultState::done);
  node.pass(100_ms);
  EXPECT_THAT(node.told(), ElementsAre(tests::Told{0x8120, 0}));
  node.pass(1_s);
  EXPECT_TRUE(node.answers());
  EXPECT_THAT(node.told(), IsEmpty());
}

void can_duplicate() {
  BusFaultBench bench;
  const auto fault = bench.inject("kind = 'can-duplicate'\ndevice = 'b'\ncount = 1");
  EXPECT_THAT(bench.ask(0x602), ElementsAre(0x582, 0x582));
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_THAT(bench.ask(0x602), ElementsAre(0x582));
}

void can_delay() {
  BusFaultBench bench;
  bench.inject("kind = 'can-delay'\ndevice = 'b'\ndelay = '200ms'\ncount = 1");
  EXPECT_THAT(bench.ask(0x602), IsEmpty());
  bench.port.wait(199_ms);
  EXPECT_THAT(bench.received(), IsEmpty());
  bench.port.wait(2_ms);
  EXPECT_THAT(bench.received(), ElementsAre(0x582));
  EXPECT_THAT(bench.ask(0x602), ElementsAre(0x582));
}

void can_bus_off() {
  BusFaultBench bench(500'000, 10_ms);
  const auto fault = bench.inject("kind = 'can-bus-off'\ndevice = 'b'");
  EXPECT_EQ(bench.state(fault), FaultState::done);
  const std::size_t b = bench.rack.bus(0).member_of(1);
  EXPECT_EQ(bench.bus().errors(b).state(), can::ErrorState::bus_off);
  EXPECT_EQ(bench.bus().statistics(b).bus_offs, 1U);
  bench.port.wait(30_ms);
  EXPECT_EQ(bench.bus().errors(b).state(), can::ErrorState::error_active) << "128 x 11 bits";
  EXPECT_THAT(bench.received(), ::testing::Contains(0x702));
  // What a product tells of it: Tmcc160Bus.AfterBusOffOfOneSecondItReports8140.
}

void can_error_passive() {
  BusFaultBench bench(500'000, 10_ms);
  bench.inject("kind = 'can-error-passive'\ndevice = 'b'");
  const std::size_t b = bench.rack.bus(0).member_of(1);
  EXPECT_EQ(bench.bus().errors(b).state(), can::ErrorState::error_passive);
  bench.port.wait(50_ms);
  EXPECT_EQ(bench.bus().errors(b).state(), can::ErrorState::error_active)
      << "frames have passed without errors";
  EXPECT_THAT(bench.received(), ::testing::Contains(0x702));
  FaultyNode node;
  node.inject("kind = 'can-error-passive'\ndevice = 'drive'");
  node.pass(100_ms);
  EXPECT_THAT(node.told(), ElementsAre(tests::Told{0x8120, 0}));
  EXPECT_TRUE(node.answers());
}

}  // namespace

FaultKindEffects can_effects() {
  return {
      {"can-drop", can_drop},           {"can-error-frame", can_error_frame},
      {"can-duplicate", can_duplicate}, {"can-delay", can_delay},
      {"can-bus-off", can_bus_off},     {"can-error-passive", can_error_passive},
  };
}

}  // namespace stator::rack
