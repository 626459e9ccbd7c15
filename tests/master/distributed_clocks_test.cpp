#include "master/distributed_clocks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/master.hpp"
#include "master/simulated_segment.hpp"

namespace stator::master {
namespace {

TEST(PropagationDelays, AreHalfTheDifferencesOfTheRoundTripsBehindEachSlave) {
  // Round trips of 2000, 1200 and 0 ns; local clocks start anywhere, one wraps.
  const std::vector<ReceiveTimes> times{{.port0 = 100, .port1 = 2100},
                                        {.port0 = 0xFFFFFF00, .port1 = 0xFFFFFF00U + 1200},
                                        {.port0 = 5000, .port1 = 5000}};
  EXPECT_THAT(propagation_delays(times), testing::ElementsAre(0U, 400U, 1000U));
  EXPECT_TRUE(propagation_delays({}).empty());
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

TEST(SynchronizeClocks, ABranchIsRefusedWithItsPlace) {
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
