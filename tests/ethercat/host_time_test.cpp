// "System time PDI controlled": the host disciplines the clock by edges at latch input 0.

#include <array>

#include <gtest/gtest.h>

#include "ethercat/dc_bus.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::bytes;
using testing::DcBus;
using testing::host_write;
using testing::little_endian;
using testing::number;

SlaveControllerConfiguration controlled_by_host(std::int32_t deviation_ppb = 0) {
  SlaveControllerConfiguration configuration;
  configuration.host_controls_time = true;
  configuration.clock_deviation_ppb = deviation_ppb;
  return configuration;
}

std::int64_t difference(DcBus& bus) {
  const std::uint64_t shown = bus.get(0x092C, 4);
  const auto magnitude = static_cast<std::int64_t>(shown & 0x7FFFFFFF);
  return (shown & 0x80000000) != 0 ? -magnitude : magnitude;
}

/// A rising edge at latch input 0 now; its time by the slave's clock.
std::uint64_t edge(DcBus& bus) {
  bus.slave().set_latch_input(0, false);
  bus.slave().set_latch_input(0, true);
  return bus.system_time();
}

TEST(HostControlledTime, WrittenTimeIsComparedWithTheEdgeNotWithTheAccess) {
  DcBus bus({}, controlled_by_host());
  bus.wait(SimDuration(1'000'000));
  const std::uint64_t latched = edge(bus);
  bus.wait(SimDuration(300'000));
  host_write(bus.slave(), 0x0910, little_endian(latched - 5'000, 4));
  EXPECT_EQ(difference(bus), 5'000) << "local ahead by what it was at the edge";
}

TEST(HostControlledTime, OnlyTheLastByteSetsOffTheComparison) {
  DcBus bus({}, controlled_by_host());
  bus.wait(SimDuration(1'000'000));
  const std::uint64_t latched = edge(bus);
  const testing::Bytes reference = little_endian(latched + 700, 4);
  for (std::uint16_t i = 0; i < 4; ++i) {
    EXPECT_EQ(difference(bus), 0) << i;
    host_write(bus.slave(), static_cast<std::uint16_t>(0x0910 + i), {reference[i]});
  }
  EXPECT_EQ(difference(bus), -700) << "all four bytes count";
}

TEST(HostControlledTime, HostHasTheTimeLoopAndTheBusHasNot) {
  DcBus bus({}, controlled_by_host());
  bus.wait(SimDuration(1'000'000));
  EXPECT_EQ(bus.set(0x0910, 0x12345678, 4), 0U);
  EXPECT_EQ(bus.set(0x0920, 5, 8), 0U);
  EXPECT_EQ(bus.set(0x0928, 5, 4), 0U);
  EXPECT_EQ(bus.set(0x0930, 0x2000, 2), 0U);
  EXPECT_EQ(difference(bus), 0);
  EXPECT_EQ(bus.get(0x0920, 8), 0U);
  host_write(bus.slave(), 0x0920, little_endian(1'000'000'000, 8));
  host_write(bus.slave(), 0x0930, little_endian(0x2000, 2));
  EXPECT_EQ(bus.get(0x0920, 8), 1'000'000'000U);
  EXPECT_EQ(bus.get(0x0930, 2), 0x2000U);
  EXPECT_GT(bus.get(0x0910, 8), 1'000'000'000U) << "the bus still reads it";
}

TEST(HostControlledTime, LatchUnit0IsAlwaysTheHosts) {
  DcBus bus({}, controlled_by_host());
  EXPECT_EQ(bus.get(0x0980, 1), 0x10U);
  EXPECT_EQ(bus.set(0x0980, 0x21, 1), 1U);
  EXPECT_EQ(bus.get(0x0980, 1), 0x31U) << "the others are the master's to choose";
}

TEST(HostControlledTime, WithoutTheConfigurationTheHostWritesNothing) {
  DcBus bus;
  bus.wait(SimDuration(1'000'000));
  edge(bus);
  host_write(bus.slave(), 0x0910, little_endian(0x12345678, 4));
  host_write(bus.slave(), 0x0920, little_endian(5, 8));
  EXPECT_EQ(difference(bus), 0);
  EXPECT_EQ(bus.get(0x0920, 8), 0U);
}

TEST(HostControlledTime, EdgesOfAReferenceEveryMillisecondPullTheClockIn) {
  DcBus bus({}, controlled_by_host(20'000));  // 20 ppm fast
  constexpr std::int64_t kAhead = 3'000;
  std::int64_t off = 0;
  for (int i = 0; i < 4'000; ++i) {
    bus.wait(SimDuration(1'000'000));
    // The reference is simulated time itself, 3 us behind at the start.
    const std::int64_t reference = bus.now().nanoseconds() - kAhead;
    off = static_cast<std::int64_t>(edge(bus)) - reference;
    bus.wait(SimDuration(20'000));
    host_write(bus.slave(), 0x0910,
               little_endian(static_cast<std::uint64_t>(reference) & 0xFFFFFFFF, 4));
  }
  EXPECT_NEAR(static_cast<double>(off), 0.0, 30.0);
}

}  // namespace
}  // namespace stator::ethercat
