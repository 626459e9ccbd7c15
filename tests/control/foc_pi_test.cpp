// PI controllers, biquad filters and feed-forward of the TMC8670 in integers, against exact
// arithmetic.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/foc/biquad.hpp"
#include "stator/control/foc/control_cascade.hpp"
#include "stator/control/foc/pi_controller.hpp"

namespace stator::control::foc {
namespace {

constexpr std::int64_t kTicks = 4000;  // 25 kHz

TEST(FocPi, GivesTheDocumentsExampleOfTheClassicStructure) {
  PiController<8> pi;
  pi.configure(PiStructure::classic, {256, 32767, 32767});
  std::int32_t output = 0;
  for (int k = 0; k < 25; ++k) {  // 1000 us
    output = pi.step(100, kTicks);
  }
  EXPECT_EQ(output, 490);
  EXPECT_EQ(pi.error_sum(), 100'000);
}

TEST(FocPi, GivesTheDocumentsExampleOfTheAdvancedStructure) {
  PiController<8> pi;
  pi.configure(PiStructure::advanced, {256, 16384, 32767});
  EXPECT_EQ(pi.step(100, kTicks), 150);
  std::int32_t output = 0;
  for (int k = 1; k < 10; ++k) {
    output = pi.step(100, kTicks);
  }
  EXPECT_EQ(output, 600);
  EXPECT_EQ(pi.error_sum(), 500);
  pi.configure(PiStructure::advanced, {256, 16384, 500});
  for (int k = 0; k < 10; ++k) {
    output = pi.step(100, kTicks);
  }
  EXPECT_EQ(output, 500);
  EXPECT_EQ(pi.error_sum(), 500);
  EXPECT_EQ(pi.state().clipped, kSumClipped | kOutputClipped);
}

TEST(FocPi, OfPositionHasTwelveBitsBehindThePoint) {
  PiController<12> pi;
  pi.configure(PiStructure::advanced, {4096, 0, INT32_MAX});
  EXPECT_EQ(pi.step(65536, kTicks), 65536);
  pi.configure(PiStructure::classic, {2048, 0, INT32_MAX});
  EXPECT_EQ(pi.step(-65536, kTicks), -32768);
}

template <int p_bits>
void compare_with_exact(PiStructure structure, std::uint64_t seed, std::int64_t error_range) {
  base::Random random(seed);
  for (int round = 0; round < 300; ++round) {
    const auto p = static_cast<std::int32_t>(random.below(32768));
    const auto i = static_cast<std::int32_t>(random.below(32768));
    const auto limit = static_cast<std::int64_t>(1 + random.below(1U << (3 + round % 28)));
    PiController<p_bits> pi;
    pi.configure(structure, {p, i, limit});
    const long double gain = static_cast<long double>(p) / (1 << p_bits);
    long double integral = 0.0;
    for (int k = 0; k < 200; ++k) {
      const std::int64_t error =
          static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(2 * error_range + 1))) -
          error_range;
      const std::int32_t output = pi.step(static_cast<std::int32_t>(error), kTicks);
      const long double step = static_cast<long double>(error) * i / 32768.0L;
      integral += structure == PiStructure::advanced ? gain * step : step * 40.0L / 256.0L;
      const long double most = static_cast<long double>(limit);
      integral = std::clamp(integral, -most, most);
      const long double exact = std::clamp(gain * error + integral, -most, most);
      // Two roundings downwards.
      ASSERT_LE(output, exact + 0.001L) << "round " << round << " period " << k;
      ASSERT_GE(output, exact - 2.001L) << "round " << round << " period " << k;
    }
  }
}

TEST(FocPi, AdvancedIsWithinTwoStepsOfTheExactOne) {
  compare_with_exact<8>(PiStructure::advanced, 1, 65535);
  compare_with_exact<12>(PiStructure::advanced, 2, INT32_MAX);
}

TEST(FocPi, ClassicIsWithinTwoStepsOfTheExactOne) {
  compare_with_exact<8>(PiStructure::classic, 3, 65535);
  compare_with_exact<12>(PiStructure::classic, 4, INT32_MAX);
}

TEST(FocPi, SaturatedComesBackAsSoonAsTheErrorTurns) {
  for (const PiStructure structure : {PiStructure::classic, PiStructure::advanced}) {
    PiController<8> pi;
    pi.configure(structure, {256, 8192, 1000});
    for (int k = 0; k < 10'000; ++k) {
      pi.step(500, kTicks);
    }
    EXPECT_EQ(pi.step(500, kTicks), 1000);
    EXPECT_LT(pi.step(-10, kTicks), 1000);
  }
}

TEST(FocPi, ChangingIJumpsClassicAndDoesNotAdvanced) {
  for (const PiStructure structure : {PiStructure::classic, PiStructure::advanced}) {
    PiController<8> pi;
    pi.configure(structure, {256, 1000, 30'000});
    for (int k = 0; k < 2000; ++k) {
      pi.step(20, kTicks);
    }
    const std::int32_t before = pi.step(0, kTicks);
    pi.configure(structure, {256, 2000, 30'000});
    const std::int32_t after = pi.step(0, kTicks);
    if (structure == PiStructure::advanced) {
      EXPECT_EQ(after, before);
    } else {
      EXPECT_GT(after, before * 3 / 2);
    }
  }
}

TEST(FocPi, ClassicWithoutIHoldsItsIntegralAtZero) {
  PiController<8> pi;
  pi.configure(PiStructure::classic, {256, 0, 30'000});
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(pi.step(1000, kTicks), 1000);
  }
  EXPECT_EQ(pi.error_sum(), 0);
  pi.configure(PiStructure::classic, {256, 100, 30'000});
  EXPECT_EQ(pi.step(0, kTicks), 0);
}

TEST(FocPi, IntegratesErrorsHoweverSmall) {
  PiController<8> pi;
  pi.configure(PiStructure::advanced, {256, 1, 30'000});
  for (int k = 0; k < 32768 * 5; ++k) {
    pi.step(1, kTicks);
  }
  EXPECT_EQ(pi.error_sum(), 5);
}

TEST(FocPi, NeverOverflows) {
  base::Random random(5);
  for (int round = 0; round < 2000; ++round) {
    PiController<12> pi;
    const auto structure = round % 2 == 0 ? PiStructure::classic : PiStructure::advanced;
    pi.configure(structure, {static_cast<std::int32_t>(random.below(65536)) - 32768,
                             static_cast<std::int32_t>(random.below(65536)) - 32768, INT32_MAX});
    for (int k = 0; k < 50; ++k) {
      const std::int32_t output =
          pi.step(random.below(2) != 0 ? INT32_MAX : INT32_MIN, k % 3 == 0 ? 65536 * 128 : kTicks);
      EXPECT_GE(output, -INT32_MAX);
    }
  }
}

TEST(FocBiquad, IsWithinOneStepOfTheExactOne) {
  base::Random random(6);
  for (int round = 0; round < 100; ++round) {
    // A stable pair of poles of radius r and angle w, gain at rest 1.
    const double r = 0.5 + 0.45 * random.uniform();
    const double w = 3.0 * random.uniform();
    const double a1 = 2.0 * r * std::cos(w), a2 = -r * r;
    const double b = (1.0 - a1 - a2) / 4.0;
    const auto q = [](double value) {
      return static_cast<std::int32_t>(std::lround(value * 0x1p29));
    };
    const BiquadCoefficients c{q(a1), q(a2), q(b), q(2.0 * b), q(b), true};
    Biquad filter;
    filter.configure(c);
    double x1 = 0, x2 = 0, y1 = 0, y2 = 0;
    // What one rounding adds comes out with the sum of the poles' impulse response.
    const double bound = 1.0 + 2.0 / ((1.0 - r) * (1.0 - r));
    for (int k = 0; k < 1000; ++k) {
      const auto x = static_cast<std::int32_t>(random.below(2'000'001)) - 1'000'000;
      const double y =
          (c.b0 * static_cast<double>(x) + c.b1 * x1 + c.b2 * x2 + c.a1 * y1 + c.a2 * y2) * 0x1p-29;
      x2 = x1;
      x1 = x;
      y2 = y1;
      y1 = y;
      ASSERT_NEAR(filter.step(x), y, bound) << round << ' ' << k;
    }
  }
}

TEST(FocBiquad, ComesToRestExactlyOnItsInput) {
  // First-order low pass of 1/64 per period, as a biquad.
  Biquad filter;
  filter.configure({(1 << 29) - (1 << 23), 0, 1 << 23, 0, 0, true});
  for (const std::int32_t target : {1000, -7, 3'000'000, 0}) {
    std::int32_t output = 0;
    std::int64_t sum = 0;
    for (int k = 0; k < 6000; ++k) {
      output = filter.step(target);
      sum += k >= 5000 ? output - target : 0;
    }
    EXPECT_LE(std::abs(output - target), 1);
    EXPECT_LE(std::abs(sum), 64);  // right in the mean
  }
}

TEST(FocBiquad, PassesEverythingWhileDisabledAndSaturates) {
  Biquad filter;
  EXPECT_EQ(filter.step(123), 123);
  filter.configure({0, 0, INT32_MAX, INT32_MAX, INT32_MAX, true});
  filter.preset(INT32_MAX);
  EXPECT_EQ(filter.step(INT32_MAX), INT32_MAX);
  filter.preset(INT32_MIN);
  EXPECT_EQ(filter.step(INT32_MIN), INT32_MIN);
}

TEST(FocFeedForward, FollowsTheDerivativeThroughItsFilter) {
  FeedForward ahead;
  ahead.configure(3 << 15, 0);  // 1.5
  EXPECT_EQ(ahead.step(100), 150);
  EXPECT_EQ(ahead.step(0), 0);
  ahead.configure(1 << 16, 1 << 14);  // a quarter per period
  ahead.reset();
  double exact = 0.0;
  base::Random random(7);
  for (int k = 0; k < 10'000; ++k) {
    const auto change = static_cast<std::int32_t>(random.below(2001)) - 1000;
    exact += (change - exact) / 4.0;
    EXPECT_NEAR(ahead.step(change), exact, 1.01);
  }
}

TEST(FocMotionModes, AreNumberedAsTheListHasThem) {
  EXPECT_EQ(motion_mode(0).loop, Loop::stopped);
  EXPECT_EQ(motion_mode(1).loop, Loop::torque);
  EXPECT_EQ(motion_mode(2).loop, Loop::velocity);
  EXPECT_EQ(motion_mode(3).loop, Loop::position);
  EXPECT_EQ(motion_mode(8).loop, Loop::voltage);
  EXPECT_EQ(motion_mode(9).loop, Loop::mini_move);
  EXPECT_EQ(motion_mode(11).source, TargetSource::analog_pin);
  EXPECT_EQ(motion_mode(15).source, TargetSource::pwm_pin);
  EXPECT_EQ(motion_mode(15).loop, Loop::position);
  EXPECT_EQ(motion_mode(16).loop, Loop::stopped);
  EXPECT_EQ(motion_mode(255).loop, Loop::stopped);
}

}  // namespace
}  // namespace stator::control::foc
