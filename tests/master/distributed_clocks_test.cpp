// Propagation delays that a master computes of receive times, in lines and trees, and clocks it
// sets by them.
#include "stator/master/distributed_clocks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/simulated_segment.hpp"
#include "stator/master/master.hpp"

namespace stator::master {
namespace {

TEST(PropagationDelays, AreHalfTheDifferencesOfTheRoundTripsBehindEachSlave) {
  // Round trips of 2000, 1200 and 0 ns; local clocks start anywhere, one wraps.
  const std::vector<ReceiveTimes> times{{.ports = {100, 2100}, .open = 3},
                                        {.ports = {0xFFFFFF00, 0xFFFFFF00U + 1200}, .open = 3},
                                        {.ports = {5000}, .open = 1}};
  EXPECT_THAT(propagation_delays(times), testing::ElementsAre(0U, 400U, 1000U));
  EXPECT_TRUE(propagation_delays({}).empty());
}

// Forwarding takes 300 ns everywhere: a junction, a slave behind 100 ns of cable at port 3, a line
// of two behind 200 and 50 ns at port 1, one behind 400 ns at port 2.
TEST(PropagationDelays, OfATreeFollowTheWayOfTheFrame) {
  const std::vector<ReceiveTimes> times{
      {.ports = {0, 2500, 3900, 800}, .open = 0xF},
      {.ports = {7}, .open = 1},           // at port 3: 300 + 100
      {.ports = {1000, 1700}, .open = 3},  // at port 1: 800 + 300 + 200
      {.ports = {3}, .open = 1},           // behind that one: 300 + 50
      {.ports = {9}, .open = 1},           // at port 2: 2500 + 300 + 400
  };
  EXPECT_THAT(propagation_delays(times), testing::ElementsAre(0U, 400U, 1300U, 1650U, 3200U));
}

TEST(SynchronizeClocks, SystemTimesOfAllSlavesAgreeAfterwards) {
  test::SimulatedSegment segment(3);
  // Different starting points of the local clocks.
  segment.wait(base::SimDuration(1'000'000));
  segment.slave(1).controller.power_on_reset();
  segment.wait(base::SimDuration(3'000'000));
  segment.slave(2).controller.power_on_reset();

  Master master(segment);
  ASSERT_TRUE(master.scan());
  const auto synchronized = master.synchronize_clocks();
  ASSERT_TRUE(synchronized) << synchronized.error().text;

  const base::SimTime now = segment.now();
  const auto reference = segment.slave(0).controller.system_time(now);
  for (const std::size_t position : {std::size_t{1}, std::size_t{2}}) {
    const auto time = segment.slave(position).controller.system_time(now);
    EXPECT_NEAR(static_cast<double>(time), static_cast<double>(reference), 20.0)
        << "slave " << position;
  }
}

TEST(SynchronizeClocks, AnEmptyScanHasNoReference) {
  test::SimulatedSegment segment(1);
  MasterOptions options;
  Bus bus(segment, options);
  const auto reference = synchronize_clocks(bus, {});
  ASSERT_TRUE(reference);
  EXPECT_FALSE(reference->has_value());
}

TEST(SynchronizeClocks, ABranchWithASlaveThatHasNoClockIsRefusedWithItsPlace) {
  test::SimulatedSegment segment(1);
  MasterOptions options;
  Bus bus(segment, options);
  Slave branch{.position = 0, .station_address = 0x1001};
  branch.ports[3].loop_closed = false;
  const auto reference = synchronize_clocks(bus, std::span(&branch, 1));
  ASSERT_FALSE(reference);
  EXPECT_EQ(reference.error().code, ErrorCode::configuration);
  EXPECT_THAT(reference.error().text, testing::HasSubstr("branches at slave 0"));
}

}  // namespace
}  // namespace stator::master
