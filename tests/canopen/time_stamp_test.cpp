#include <gtest/gtest.h>

#include "sdo_client.hpp"

namespace stator::canopen {
namespace {

/// 12:34:56.789 on 2026-01-02.
constexpr TimeOfDay kTime{.milliseconds = 45'296'789, .days = 15'342};

void receive_time(NodeBench& bench) {
  bench.receive(0x100, {0x95, 0x2C, 0xB3, 0x02, 0xEE, 0x3B});
}

TEST(TimeStamp, Consumer_TakesTheNetworksTimeAndLetsItPass) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now), std::nullopt);
  receive_time(bench);
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now), kTime);
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now + 43'200_s),
            (TimeOfDay{.milliseconds = kTime.milliseconds + 43'200'000 - 86'400'000,
                       .days = static_cast<std::uint16_t>(kTime.days + 1)}));
}

TEST(TimeStamp, Consumer_IsOffWithoutBit31) {
  NodeBench bench;
  bench.boot();
  ask(bench, {0x23, 0x12, 0x10, 0, 0x00, 0x01, 0, 0});
  receive_time(bench);
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now), std::nullopt);
}

TEST(TimeStamp, Consumer_ListensToTheConfiguredIdentifier) {
  NodeBench bench;
  bench.boot();
  EXPECT_EQ(ask(bench, {0x23, 0x12, 0x10, 0, 0x81, 0x00, 0, 0x80}), aborted(0x1012, 0, 0x08000022))
      << "not while the object exists";
  ask(bench, {0x23, 0x12, 0x10, 0, 0x81, 0x00, 0, 0x00});
  ask(bench, {0x23, 0x12, 0x10, 0, 0x81, 0x00, 0, 0x80});
  receive_time(bench);
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now), std::nullopt);
  bench.receive(0x081, {0x95, 0x2C, 0xB3, 0x02, 0xEE, 0x3B});
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now), kTime);
}

TEST(TimeStamp, Consumer_IgnoresFramesInStoppedAndOfWrongLength) {
  NodeBench bench;
  bench.boot();
  bench.receive(0x100, {0x95, 0x2C, 0xB3, 0x02, 0xEE});
  EXPECT_TRUE(bench.events.tells("time stamp ignored: it has 5 bytes, TIME_OF_DAY has 6"));
  bench.nmt(2);
  receive_time(bench);
  EXPECT_EQ(bench.node.time_stamp().time_of_day(bench.now), std::nullopt);
}

TEST(TimeStamp, Producer_SendsWhereBit30AllowsIt) {
  NodeBench bench;
  bench.boot();
  EXPECT_FALSE(bench.node.time_stamp().produce(kTime, bench.now));
  ask(bench, {0x23, 0x12, 0x10, 0, 0x00, 0x01, 0, 0x40});
  EXPECT_TRUE(bench.node.time_stamp().produce(kTime, bench.now));
  EXPECT_EQ(to_text(bench.take()), Texts{"100 [95 2C B3 02 EE 3B]"});
  bench.nmt(2);
  EXPECT_FALSE(bench.node.time_stamp().produce(kTime, bench.now));
}

}  // namespace
}  // namespace stator::canopen
