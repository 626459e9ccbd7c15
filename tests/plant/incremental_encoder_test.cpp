// Counts and index of an encoder against an integer formula over revolutions and leaps.
#include "stator/plant/sensors/incremental_encoder.hpp"

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::plant {
namespace {

constexpr std::int64_t kPolePairs = 50;

/// The shaft after `numerator` / 2^10 electrical periods.
ElectricalAngle at(std::int64_t numerator) {
  const std::int64_t periods = numerator >> 10;
  return {periods, static_cast<double>(numerator - (periods << 10)) / 1024.0 * base::kTwoPi};
}

/// floor(cpr * numerator / (2^10 * p) + 1/2) in integers.
std::int64_t expected_count(std::int64_t numerator, std::int64_t cpr) {
  const std::int64_t divisor = 2 * 1024 * kPolePairs;
  const std::int64_t dividend = 2 * cpr * numerator + 1024 * kPolePairs;
  const std::int64_t quotient = dividend / divisor;
  return dividend % divisor < 0 ? quotient - 1 : quotient;
}

TEST(IncrementalEncoder, CountsAreTheIntegerFormulaAtEveryMicrostepOfThreeRevolutions) {
  for (const std::int64_t cpr : {4'000, 10'000, 40'000, 9'973}) {
    const IncrementalEncoder encoder({.counts_per_revolution = cpr}, kPolePairs);
    EncoderState state = encoder.power_on({});
    for (std::int64_t position = 0; position < 3 * 51'200; ++position) {
      encoder.update(state, at(position));
      ASSERT_EQ(encoder.count(state), expected_count(position, cpr)) << cpr << " at " << position;
    }
    for (std::int64_t position = 3 * 51'200; position > -3 * 51'200; --position) {
      encoder.update(state, at(position));
      ASSERT_EQ(encoder.count(state), expected_count(position, cpr)) << cpr << " at " << position;
    }
  }
}

TEST(IncrementalEncoder, IsExactAfterManyTurns) {
  const IncrementalEncoder encoder({.counts_per_revolution = 40'000}, kPolePairs);
  base::Random random(5);
  for (int i = 0; i < 100'000; ++i) {
    const auto position = static_cast<std::int64_t>(random.next() >> 20U) - (std::int64_t{1} << 43);
    EncoderState state;
    state.index_below = expected_count(position, 40'000);  // keeps the search for marks short
    encoder.update(state, at(position));
    ASSERT_EQ(encoder.count(state), expected_count(position, 40'000));
  }
}

TEST(IncrementalEncoder, CountsFromZeroWhereverTheShaftStandsAtPowerOn) {
  const IncrementalEncoder encoder({.counts_per_revolution = 40'000}, kPolePairs);
  EncoderState state = encoder.power_on(at(12'800));
  EXPECT_EQ(encoder.count(state), 0);
  encoder.update(state, at(25'600));
  EXPECT_EQ(encoder.count(state), 10'000);
}

TEST(IncrementalEncoder, ReversedDiscCountsDownwards) {
  const IncrementalEncoder encoder({.counts_per_revolution = 40'000, .reversed = true}, kPolePairs);
  EncoderState state = encoder.power_on({});
  encoder.update(state, at(51'200));
  EXPECT_EQ(encoder.count(state), -40'000);
}

TEST(IncrementalEncoder, IndexIsHighForOneCountPerRevolution) {
  const IncrementalEncoder encoder({.counts_per_revolution = 4'000, .index_position = 100},
                                   kPolePairs);
  EncoderState state = encoder.power_on({});
  int counts_with_index = 0;
  std::int64_t last = 0;
  for (std::int64_t position = 1; position <= 5 * 51'200; ++position) {
    encoder.update(state, at(position));
    if (encoder.count(state) != last) {
      last = encoder.count(state);
      counts_with_index += encoder.index(state) ? 1 : 0;
      ASSERT_EQ(encoder.index(state), last % 4'000 == 100);
    }
  }
  EXPECT_EQ(counts_with_index, 5);
  EXPECT_EQ(state.index_passages, 5U);
}

TEST(IncrementalEncoder, IndexPassedWithinOneStepIsLatchedAtItsOwnCount) {
  const IncrementalEncoder encoder({.counts_per_revolution = 40'000, .index_position = 1'000},
                                   kPolePairs);
  EncoderState state = encoder.power_on({});
  encoder.update(state, at(1'270));  // count 992
  EXPECT_EQ(state.index_passages, 0U);
  encoder.update(state, at(1'320));  // count 1031
  EXPECT_FALSE(encoder.index(state));
  EXPECT_EQ(state.index_passages, 1U);
  EXPECT_EQ(encoder.index_count(state), 1'000);
  encoder.update(state, at(1'270));
  EXPECT_EQ(state.index_passages, 2U);
  EXPECT_EQ(encoder.index_count(state), 1'000);
  encoder.update(state, at(1'270 - 51'200));
  EXPECT_EQ(state.index_passages, 3U);
  EXPECT_EQ(encoder.index_count(state), 1'000 - 40'000);
}

TEST(IncrementalEncoder, StandingOnTheIndexIsOnePassageAndLeavingItNone) {
  const IncrementalEncoder encoder({.counts_per_revolution = 40'000, .index_position = 1'000},
                                   kPolePairs);
  EncoderState state = encoder.power_on({});
  encoder.update(state, at(1'280));  // count 1000
  EXPECT_TRUE(encoder.index(state));
  EXPECT_EQ(state.index_passages, 1U);
  encoder.update(state, at(1'270));
  EXPECT_EQ(state.index_passages, 1U);
  encoder.update(state, at(1'280));
  EXPECT_EQ(state.index_passages, 2U);
  encoder.update(state, at(1'290));
  EXPECT_EQ(state.index_passages, 2U);
}

TEST(IncrementalEncoder, AnActiveLowIndexIsHighEverywhereElse) {
  const IncrementalEncoder encoder(
      {.counts_per_revolution = 4'000, .index_position = 0, .index_active_low = true}, 50);
  EncoderState state = encoder.power_on({});
  EXPECT_FALSE(encoder.index(state));
  encoder.update(state, {.periods = 1});
  EXPECT_TRUE(encoder.index(state));
}

TEST(IncrementalEncoder, ManyCountsAtOnceMeetTheMarksThatCountByCountAreMet) {
  IncrementalEncoder encoder({.counts_per_revolution = 8, .index_position = 3}, kPolePairs);
  EncoderState walks = encoder.power_on({});
  EncoderState leaps = walks;
  base::Random random(22);
  std::int64_t place = 0;
  const auto update = [&encoder](EncoderState& state, std::int64_t count) {
    encoder.set_slipped(-static_cast<double>(count));
    encoder.update(state, {});
  };
  for (int i = 0; i < 10'000; ++i) {
    const std::int64_t target = place + static_cast<std::int64_t>(random.below(61)) - 30;
    for (; place != target; place += place < target ? 1 : -1) {
      update(walks, place);
    }
    update(walks, target);
    update(leaps, target);
    ASSERT_EQ(leaps.absolute, target);
    ASSERT_EQ(leaps.index_below, walks.index_below) << i;
    ASSERT_EQ(leaps.latest_index, walks.latest_index) << i;
    ASSERT_EQ(leaps.index_passages, walks.index_passages) << i;
  }
}

TEST(IncrementalEncoder, ALeapOfManyRevolutionsTakesNoLongerThanOne) {
  IncrementalEncoder encoder({.counts_per_revolution = 4'000}, kPolePairs);
  EncoderState state = encoder.power_on({});
  encoder.set_slipped(-4e15);
  encoder.update(state, {});
  EXPECT_EQ(state.latest_index, 4'000'000'000'000'000);
  EXPECT_EQ(state.index_passages, static_cast<std::uint32_t>(1'000'000'000'000));
  encoder.set_slipped(0);
  encoder.update(state, {});
  EXPECT_EQ(state.latest_index, 0);
}

TEST(IncrementalEncoder, NoneFittedCountsNothing) {
  const IncrementalEncoder encoder({.counts_per_revolution = 0}, kPolePairs);
  EncoderState state = encoder.power_on({});
  encoder.update(state, at(51'200));
  EXPECT_EQ(encoder.count(state), 0);
  EXPECT_FALSE(encoder.index(state));
}

}  // namespace
}  // namespace stator::plant
