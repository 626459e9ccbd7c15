// SYNC with and without counter as consumer and producer (CiA 301 §7.2.5), and objects 1005h, 1006h
// and 1019h.
#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using namespace base::literals;
using test::emergency_frame;
using test::ServiceBench;

constexpr std::uint32_t kRangeExceeded = 0x06090030;
constexpr std::uint32_t kDeviceState = 0x08000022;

/// The counters of SYNC messages sent, -1 for one without.
std::vector<int> take_counters(ServiceBench& bench) {
  std::vector<int> counters;
  for (const can::Frame& frame : bench.take_sent()) {
    if (frame.identifier == 0x80) {
      counters.push_back(frame.length == 0 ? -1 : std::to_integer<int>(frame.data[0]));
    }
  }
  return counters;
}

TEST(SyncConsumer, FollowsItsCanId) {
  ServiceBench bench;
  EXPECT_TRUE(bench.receive(0x80, {}));
  EXPECT_EQ(bench.write(0x1005, 0, 0x90), 0U);
  EXPECT_FALSE(bench.receive(0x80, {}));
  EXPECT_TRUE(bench.receive(0x90, {}));
  EXPECT_FALSE(bench.receive(can::remote_frame(0x90)));
}

TEST(SyncConsumer, WrongLength_IsReportedAndPassedOver) {
  ServiceBench bench;
  bench.operational();
  bench.take_sent();
  bench.receive(0x80, {1});
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8240, 0x11)});
  bench.receive(0x80, {});
  EXPECT_EQ(bench.take_sent().front(), emergency_frame(0x0000, 0x00));
  EXPECT_EQ(bench.write(0x1019, 0, 5), 0U);
  bench.receive(0x80, {});
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8240, 0x11)});
  EXPECT_EQ(bench.sync.malformed(), 2U);
}

TEST(SyncConsumer, CounterOverflow_HasLegalValuesAndARestPeriod) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1019, 0, 1), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1019, 0, 241), kRangeExceeded);
  EXPECT_EQ(bench.write(0x1019, 0, 240), 0U);
  EXPECT_EQ(bench.write(0x1019, 0, 2), 0U);
  EXPECT_EQ(bench.write(0x1006, 0, 1000), 0U);
  EXPECT_EQ(bench.write(0x1019, 0, 0), kDeviceState);
}

TEST(SyncProducer, SendsWithThePeriodOf1006hWhileBit30IsSet) {
  ServiceBench bench;
  bench.write(0x1006, 0, 10'000);
  bench.wait(1_s);
  EXPECT_TRUE(take_counters(bench).empty());
  EXPECT_EQ(bench.write(0x1005, 0, 0x40000080), 0U);
  bench.wait(100_ms);
  EXPECT_EQ(take_counters(bench), std::vector<int>(10, -1));
  bench.write(0x1006, 0, 0);
  bench.wait(1_s);
  EXPECT_TRUE(take_counters(bench).empty());
}

TEST(SyncProducer, Counter_GoesFromOneToItsOverflow) {
  ServiceBench bench;
  bench.write(0x1019, 0, 5);
  bench.write(0x1006, 0, 1000);
  bench.write(0x1005, 0, 0x40000080);
  bench.wait(7_ms);
  EXPECT_EQ(take_counters(bench), (std::vector{1, 2, 3, 4, 5, 1, 2}));
}

TEST(SyncProducer, Stopped_SilencesItAndTheCounterBeginsAnew) {
  ServiceBench bench;
  bench.write(0x1019, 0, 5);
  bench.write(0x1006, 0, 1000);
  bench.write(0x1005, 0, 0x40000080);
  bench.wait(3_ms);
  bench.operational();
  bench.wait(1_ms);
  EXPECT_EQ(take_counters(bench), (std::vector{1, 2, 3, 4})) << "Operational goes on counting";
  bench.enter(NmtState::stopped);
  bench.wait(3_ms);
  EXPECT_TRUE(take_counters(bench).empty());
  bench.operational();
  bench.wait(2_ms);
  EXPECT_EQ(take_counters(bench), (std::vector{1, 2}));
}

TEST(SyncProducer, OwnSync_TriggersOwnPdos) {
  ServiceBench bench;
  bench.write(0x1006, 0, 1000);
  bench.write(0x1005, 0, 0x40000080);
  bench.operational();
  bench.wait(5_ms);
  EXPECT_EQ(bench.take_count(0x385), 5U);
}

}  // namespace
}  // namespace stator::canopen
