#include "stator/control/servo/velocity_meter.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace stator::control {
namespace {

/// A signal of `rate` increments per period, measured every 20 periods.
class Meter : public testing::Test {
 protected:
  double worst_after(double rate, int windows, int settle) {
    double worst = 0.0;
    for (int w = 0; w < windows; ++w) {
      run(rate);
      if (w >= settle) {
        worst = std::max(worst, std::fabs(meter_.velocity() - rate));
      }
    }
    return worst;
  }
  void run(double rate) {
    for (int k = 0; k < 20; ++k) {
      way_ += rate;
      meter_.note(static_cast<std::int64_t>(std::floor(way_)), ++period_);
    }
    meter_.measure(period_);
  }
  VelocityMeter meter_;
  double way_ = 0.0;
  std::uint32_t period_ = 0xFFFF'F000U;  // the counter wraps in the middle
  void SetUp() override { meter_.place(0, period_); }
};

TEST_F(Meter, AFastSignalIsKnownToOneIncrementPerWindow) {
  for (const double rate : {13.37, 1.5, -7.77}) {
    EXPECT_LE(worst_after(rate, 400, 2), 1.0 / 20.0 + 1e-9) << rate;
  }
}

TEST_F(Meter, ASlowSignalIsKnownToTheShareOfAPeriodInItsInterval) {
  for (const double rate : {0.01, 0.002, -0.01, 0.0007}) {
    EXPECT_LE(worst_after(rate, 2000, 300), 2.0 * rate * rate + 1e-9) << rate;
  }
}

TEST_F(Meter, WithoutEdgesTheVelocityFadesAndEndsAtZero) {
  for (int k = 0; k < 10; ++k) {
    run(0.5);
  }
  run(0.0);
  const double before = meter_.velocity();
  run(0.0);
  EXPECT_LE(meter_.velocity(), 1.0 / 40.0 + 1e-9);
  EXPECT_LT(meter_.velocity(), before);
  for (int k = 0; k < 260; ++k) {
    run(0.0);
  }
  EXPECT_EQ(meter_.velocity(), 0.0);
}

TEST_F(Meter, StandingOnAnEdgeIsNoVelocity) {
  for (int k = 0; k < 10; ++k) {
    meter_.note(k % 2, ++period_);
    period_ += 19;
    meter_.measure(period_);
    if (k > 1) {
      EXPECT_EQ(meter_.velocity(), 0.0) << k;
    }
  }
}

TEST_F(Meter, AMonthOfStandstillDoesNotConfuseIt) {
  for (int k = 0; k < 3; ++k) {
    for (int hour = 0; hour < 1000; ++hour) {
      period_ += 4900;
      meter_.measure(period_);
    }
  }
  run(1.0);
  run(1.0);
  EXPECT_NEAR(meter_.velocity(), 1.0, 0.051);
}

}  // namespace
}  // namespace stator::control
