// Arithmetic of simulated time: saturation at both ends, whole periods and rests, never().
#include "stator/base/sim_time.hpp"

#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

constexpr std::int64_t kLowest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kHighest = std::numeric_limits<std::int64_t>::max();

TEST(SimDuration, LiteralsCountNanoseconds) {
  EXPECT_EQ((7_ns).nanoseconds(), 7);
  EXPECT_EQ((7_us).nanoseconds(), 7'000);
  EXPECT_EQ((7_ms).nanoseconds(), 7'000'000);
  EXPECT_EQ((7_s).nanoseconds(), 7'000'000'000);
}

TEST(SimDuration, AdditionSaturatesAtBothEnds) {
  EXPECT_EQ((SimDuration(kHighest - 1) + 1_ns).nanoseconds(), kHighest);
  EXPECT_EQ((SimDuration(kHighest) + 1_ns).nanoseconds(), kHighest);
  EXPECT_EQ((SimDuration(kLowest) + SimDuration(-1)).nanoseconds(), kLowest);
  EXPECT_EQ((SimDuration(kHighest) + SimDuration(kLowest)).nanoseconds(), -1);
}

TEST(SimDuration, SubtractionSaturatesAtBothEnds) {
  EXPECT_EQ((SimDuration(kHighest) - SimDuration(-1)).nanoseconds(), kHighest);
  EXPECT_EQ((SimDuration(kLowest) - 1_ns).nanoseconds(), kLowest);
  EXPECT_EQ((SimDuration(0) - SimDuration(kLowest)).nanoseconds(), kHighest);
}

TEST(SimDuration, MultiplicationSaturatesWithTheSignOfTheProduct) {
  EXPECT_EQ((3_us * 4).nanoseconds(), 12'000);
  EXPECT_EQ((SimDuration(kHighest) * 2).nanoseconds(), kHighest);
  EXPECT_EQ((SimDuration(kHighest) * -2).nanoseconds(), kLowest);
  EXPECT_EQ((SimDuration(kLowest) * 2).nanoseconds(), kLowest);
  EXPECT_EQ((SimDuration(kLowest) * -1).nanoseconds(), kHighest);
}

TEST(SimDuration, DivisionCountsWholePeriodsAndModuloGivesTheRest) {
  EXPECT_EQ(10_ms / 3_ms, 3);
  EXPECT_EQ((10_ms % 3_ms), 1_ms);
}

TEST(SimDuration, CompoundAssignmentSaturatesToo) {
  SimDuration duration(kHighest - 5);
  duration += 10_ns;
  EXPECT_EQ(duration, SimDuration::max());
  duration -= 10_ns;
  EXPECT_EQ(duration.nanoseconds(), kHighest - 10);
}

TEST(SimTime, StartsAtPowerOn) {
  EXPECT_EQ(SimTime().nanoseconds(), 0);
  EXPECT_EQ(SimTime(1500_ms).seconds(), 1.5);
}

TEST(SimTime, MomentsAndSpansKeepTheirKinds) {
  const SimTime t(10_ms);
  EXPECT_EQ(t + 5_ms, SimTime(15_ms));
  EXPECT_EQ(t - 5_ms, SimTime(5_ms));
  EXPECT_EQ(SimTime(15_ms) - t, 5_ms);
}

TEST(SimTime, NeverIsLaterThanEverythingAndStaysNever) {
  EXPECT_GT(SimTime::never(), SimTime(SimDuration(kHighest - 1)));
  EXPECT_EQ(SimTime::never() + 1_s, SimTime::never());
  SimTime deadline = SimTime::never();
  deadline += 1_s;
  EXPECT_EQ(deadline, SimTime::never());
}

TEST(SimTime, NanosecondsSurviveAYearOfRunning) {
  const SimTime year(SimDuration(365LL * 24 * 3600 * 1'000'000'000));
  EXPECT_EQ((year + 1_ns) - year, 1_ns);
}

}  // namespace
}  // namespace stator::base
