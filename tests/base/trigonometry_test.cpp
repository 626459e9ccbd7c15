// Error bound and bits of the portable sine and cosine against the C library in extended precision.
#include "stator/base/trigonometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::base {
namespace {

constexpr double kErrorBound = 2.5e-16;

/// The larger of both errors against the C library in extended precision.
double error_at(double angle) {
  const SineCosine own = sine_cosine(angle);
  const long double sine = std::sin(static_cast<long double>(angle));
  const long double cosine = std::cos(static_cast<long double>(angle));
  return static_cast<double>(std::max(std::fabs(own.sine - sine), std::fabs(own.cosine - cosine)));
}

double worst_error(double limit, int samples) {
  Random random(0x51BE);
  double worst = 0.0;
  for (int i = 0; i < samples; ++i) {
    worst = std::max(worst, error_at((2.0 * random.uniform() - 1.0) * limit));
  }
  return worst;
}

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

TEST(SineCosine, IsExactAtZero) {
  EXPECT_EQ(sine_cosine(0.0).sine, 0.0);
  EXPECT_EQ(sine_cosine(0.0).cosine, 1.0);
}

TEST(SineCosine, ErrorIsBelowTheDocumentedBoundInTheWholeRange) {
  for (const double limit : {kPi / 4.0, kTwoPi, 100.0, 1e4, 1e6}) {
    EXPECT_LT(worst_error(limit, 100'000), kErrorBound) << "for angles up to " << limit;
  }
}

TEST(SineCosine, QuadrantBordersAreAsGoodAsTheRest) {
  for (int eighth = -800'000; eighth <= 800'000;
       eighth += eighth < 4000 && eighth > -4000 ? 1 : 997) {
    const double border = eighth * (kPi / 4.0);
    for (const double angle : {std::nextafter(border, -1e9), border, std::nextafter(border, 1e9)}) {
      ASSERT_LT(error_at(angle), kErrorBound) << "at " << angle;
    }
  }
}

TEST(SineCosine, SineIsOddAndCosineIsEvenToTheBit) {
  Random random(77);
  for (int i = 0; i < 10'000; ++i) {
    const double angle = random.uniform() * 1000.0;
    const SineCosine positive = sine_cosine(angle);
    const SineCosine negative = sine_cosine(-angle);
    ASSERT_EQ(positive.sine, -negative.sine) << "at " << angle;
    ASSERT_EQ(positive.cosine, negative.cosine) << "at " << angle;
  }
}

// One number over all bits of many results: it is the same for every compiler, optimisation and
// processor, and a change of it changes every recorded run.
TEST(SineCosine, HasTheSameBitsEverywhere) {
  Random random(2024);
  std::uint64_t digest = 0;
  for (int i = 0; i < 100'000; ++i) {
    const SineCosine value = sine_cosine((random.uniform() - 0.5) * 2000.0);
    digest = (digest ^ bits_of(value.sine)) * 0x100000001B3U;
    digest = (digest ^ bits_of(value.cosine)) * 0x100000001B3U;
  }
  EXPECT_EQ(digest, 11292695764634119439U);
}

}  // namespace
}  // namespace stator::base
