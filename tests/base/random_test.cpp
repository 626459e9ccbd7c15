#include "stator/base/random.hpp"

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

// The sequence of the published SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom
// number generators", 2014): recordings made years ago must replay, so it never changes.
TEST(Random, SeedGivesThePublishedSequence) {
  Random random(1234567);
  constexpr std::array<std::uint64_t, 5> kPublished{6457827717110365317U, 3203168211198807973U,
                                                    9817491932198370423U, 4593380528125082431U,
                                                    16408922859458223821U};
  for (const std::uint64_t expected : kPublished) {
    EXPECT_EQ(random.next(), expected);
  }
}

TEST(Random, SeedZeroIsAsGoodAsAnyOther) {
  Random random(0);
  EXPECT_EQ(random.next(), 0xE220A8397B1DCDAFU);
  EXPECT_EQ(random.next(), 0x6E789E6AA1B965F4U);
}

TEST(Random, CopiesContinueWithTheSameNumbers) {
  Random random(99);
  random.next();
  Random copy = random;
  EXPECT_EQ(random.next(), copy.next());
}

TEST(Random, UniformFillsTheUnitIntervalEvenly) {
  Random random(5);
  double sum = 0.0;
  double sum_of_squares = 0.0;
  constexpr int kCount = 100'000;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.uniform();
    ASSERT_GE(value, 0.0);
    ASSERT_LT(value, 1.0);
    sum += value;
    sum_of_squares += value * value;
  }
  EXPECT_NEAR(sum / kCount, 1.0 / 2.0, 0.005);
  EXPECT_NEAR(sum_of_squares / kCount, 1.0 / 3.0, 0.005);
}

TEST(Random, BelowReachesEveryNumberUnderItsBound) {
  Random random(11);
  std::array<int, 6> counts{};
  for (int i = 0; i < 6'000; ++i) {
    ++counts.at(random.below(6));
  }
  for (const int count : counts) {
    EXPECT_NEAR(count, 1'000, 150);
  }
}

}  // namespace
}  // namespace stator::base
