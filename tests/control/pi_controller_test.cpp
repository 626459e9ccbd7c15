// The PI controllers of the TMCC160: gains in 1/256 and 1/65536, limits, sums that do not wind up.
#include "stator/control/servo/pi_controller.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::control {
namespace {

using CurrentPiController = PiController<PiFormat{}>;

constexpr std::int64_t kOne = 65536;  // of the output
constexpr std::int64_t kLimit = 10'000 * kOne;

CurrentPiController current_controller(std::uint16_t p, std::uint16_t i) {
  CurrentPiController pi;
  pi.configure(p, i);
  return pi;
}

TEST(PiController, AnswersAStepWithPOf256AndSumOf65536) {
  CurrentPiController pi = current_controller(512, 6553);
  for (int k = 1; k <= 100; ++k) {
    EXPECT_EQ(pi.step(100, kLimit), 200 * kOne + 6553 * 100 * k);
    EXPECT_EQ(pi.error(), 100);
    EXPECT_EQ(pi.sum(), 100 * k);
  }
}

TEST(PiController, AnImpulseLeavesTheIntegralPart) {
  CurrentPiController pi = current_controller(256, 1000);
  EXPECT_EQ(pi.step(-50, kLimit), -50 * kOne - 50'000);
  EXPECT_EQ(pi.step(0, kLimit), -50'000);
  EXPECT_EQ(pi.step(0, kLimit), -50'000);
}

TEST(PiController, AVelocityErrorOf256thsGivesTheSameOutput) {
  VelocityPiController fine;
  CurrentPiController coarse;
  fine.configure(500, 500);
  coarse.configure(500, 500);
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(fine.step(75 * 256, kLimit), coarse.step(75, kLimit));
  }
}

TEST(PiController, WithoutGainsThereIsNoOutput) {
  CurrentPiController pi = current_controller(0, 0);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(pi.step(30'000, kLimit), 0);
    EXPECT_EQ(pi.sum(), 0);
  }
}

TEST(PiController, StaysAtItsLimitAndLeavesItAtOnce) {
  CurrentPiController pi = current_controller(256, 6554);
  for (int k = 0; k < 10'000; ++k) {
    EXPECT_LE(pi.step(20'000, kLimit), kLimit);
  }
  EXPECT_EQ(pi.cut(), 1);
  // The error changes its sign: P alone would give -1000; what the sum may hold is one step's
  // worth.
  const std::int64_t output = pi.step(-1000, kLimit);
  EXPECT_LT(output, 2000 * kOne);
  EXPECT_EQ(pi.cut(), 0);
}

TEST(PiController, TheSumAloneDoesNotExceedTheLimit) {
  CurrentPiController pi = current_controller(0, 500);
  for (int k = 0; k < 100'000; ++k) {
    pi.step(1000, kLimit);
  }
  EXPECT_NEAR(static_cast<double>(pi.sum()), 10'000.0 * 65536.0 / 500.0, 1000.0);
  // One period later the limit is half of that: so is the sum.
  EXPECT_EQ(pi.step(0, kLimit / 2) >> 16, 5000);
  EXPECT_NEAR(static_cast<double>(pi.sum()), 5'000.0 * 65536.0 / 500.0, 1.0);
}

TEST(PiController, ALimiterBehindItStopsTheSumInThatDirectionOnly) {
  CurrentPiController pi = current_controller(256, 1000);
  pi.step(10, kLimit);
  pi.set_cut(1);
  pi.step(10, kLimit);
  EXPECT_EQ(pi.sum(), 10);
  pi.set_cut(1);
  pi.step(-4, kLimit);
  EXPECT_EQ(pi.sum(), 6);
}

TEST(PiController, IsPresetToAnOutputItHoldsWithoutError) {
  CurrentPiController pi = current_controller(500, 500);
  pi.preset(-1234 * kOne);
  EXPECT_NEAR(static_cast<double>(pi.step(0, kLimit)) / kOne, -1234.0, 0.01);
}

TEST(PiController, NeverExceedsItsLimitWhateverComes) {
  base::Random random(7);
  CurrentPiController pi = current_controller(65535, 65535);
  for (int k = 0; k < 200'000; ++k) {
    const auto error = static_cast<std::int32_t>(random.next());
    const auto limit = static_cast<std::int64_t>(random.next() >> 20U);
    const std::int64_t output = pi.step(error, limit);
    ASSERT_LE(output, limit);
    ASSERT_GE(output, -limit);
    ASSERT_LE(std::fabs(static_cast<double>(pi.sum()) * 65535.0),
              static_cast<double>(limit) + 65535.0);
  }
}

}  // namespace
}  // namespace stator::control
