// When I2t supervision trips and recovers, and when a brake chopper switches.
#include "stator/control/servo/i2t_monitor.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stator/control/servo/brake_chopper.hpp"

namespace stator::control {
namespace {

constexpr double kLimit = 5'880'000.0;  // 14 A for ever, 30 s

I2tMonitor monitor() {
  I2tMonitor i2t;
  i2t.configure(30'000, 5'880'000);
  return i2t;
}

int milliseconds_until_exceeded(I2tMonitor& i2t, double current) {
  int time = 0;
  while (!i2t.exceeded() && time < 1'000'000) {
    i2t.pass_millisecond(current * current);
    ++time;
  }
  return time;
}

TEST(I2tMonitor, SumTendsToTheSquareTimesTheTimeConstant) {
  I2tMonitor i2t = monitor();
  for (int ms = 0; ms < 30'000; ++ms) {
    i2t.pass_millisecond(100.0);
  }
  EXPECT_NEAR(i2t.sum(), 3e6 * (1.0 - std::exp(-1.0)), 100.0);
  for (int ms = 0; ms < 600'000; ++ms) {
    i2t.pass_millisecond(100.0);
  }
  EXPECT_NEAR(i2t.sum(), 3e6, 1.0);
}

TEST(I2tMonitor, FourteenAmperesAreBorneForEverAtTheDefaults) {
  I2tMonitor i2t = monitor();
  for (int ms = 0; ms < 1'000'000; ++ms) {
    i2t.pass_millisecond(14.0 * 14.0);
  }
  EXPECT_FALSE(i2t.exceeded());
}

TEST(I2tMonitor, TripsAfterTheTimeOfTheExponential) {
  for (const double current : {15.0, 20.0, 30.0, 60.0}) {
    I2tMonitor i2t = monitor();
    const double expected = -30'000.0 * std::log(1.0 - kLimit / (current * current * 30'000.0));
    EXPECT_NEAR(milliseconds_until_exceeded(i2t, current), expected, 2.0 + 1e-4 * expected)
        << current;
  }
}

TEST(I2tMonitor, TheCounterCountsTheTripAndEachSecondOfIt) {
  I2tMonitor i2t = monitor();
  milliseconds_until_exceeded(i2t, 20.0);
  EXPECT_EQ(i2t.counter(), 1U);
  for (int ms = 0; ms < 2999; ++ms) {
    i2t.pass_millisecond(0.0);
  }
  EXPECT_EQ(i2t.counter(), 3U);
  i2t.pass_millisecond(0.0);
  EXPECT_EQ(i2t.counter(), 4U);
  i2t.set_counter(77);
  EXPECT_EQ(i2t.counter(), 77U);
}

TEST(I2tMonitor, TheFlagStaysUntilClearedAndReturnsWhileTheSumIsAbove) {
  I2tMonitor i2t = monitor();
  milliseconds_until_exceeded(i2t, 20.0);
  for (int ms = 0; ms < 100; ++ms) {
    i2t.pass_millisecond(400.0);  // still above
  }
  i2t.clear_exceeded();
  EXPECT_FALSE(i2t.exceeded());
  i2t.pass_millisecond(0.0);
  EXPECT_TRUE(i2t.exceeded());
  for (int ms = 0; ms < 10'000; ++ms) {
    i2t.pass_millisecond(0.0);
  }
  EXPECT_TRUE(i2t.exceeded()) << "cold, but not cleared";
  i2t.clear_exceeded();
  i2t.pass_millisecond(0.0);
  EXPECT_FALSE(i2t.exceeded());
}

TEST(I2tMonitor, WithoutATimeConstantNothingIsSummed) {
  I2tMonitor i2t;
  i2t.configure(0, 100);
  i2t.pass_millisecond(1e6);
  EXPECT_EQ(i2t.sum(), 0U);
  EXPECT_FALSE(i2t.exceeded());
}

TEST(BrakeChopper, IsOnAboveTheLimitAndOffBelowLimitMinusHysteresis) {
  BrakeChopper chopper;
  chopper.configure(true, 26.0, 0.5);
  EXPECT_FALSE(chopper.step(25.99));
  EXPECT_FALSE(chopper.step(26.0));
  EXPECT_TRUE(chopper.step(26.01));
  EXPECT_TRUE(chopper.step(25.6));
  EXPECT_TRUE(chopper.step(25.5));
  EXPECT_FALSE(chopper.step(25.49));
  EXPECT_FALSE(chopper.step(25.9));
}

TEST(BrakeChopper, NotEnabledIsOffAtAnyVoltage) {
  BrakeChopper chopper;
  chopper.configure(true, 26.0, 0.5);
  chopper.step(30.0);
  chopper.configure(false, 26.0, 0.5);
  EXPECT_FALSE(chopper.step(30.0));
  EXPECT_FALSE(chopper.on());
}

}  // namespace
}  // namespace stator::control
