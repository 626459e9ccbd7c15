// Angle, count and errors from three Hall signals, with and without interpolation between edges.
#include "stator/control/servo/hall_decoder.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

namespace stator::control {
namespace {

constexpr std::array<std::uint8_t, 6> kCodes = {0b001, 0b011, 0b010, 0b110, 0b100, 0b101};
constexpr std::uint32_t kSlowest = 833;  // periods: 60 rpm with 4 pole pairs

double degrees(ElectricalAngle angle) {
  return static_cast<double>(angle.value) * (360.0 / 4294967296.0);
}

/// Codes of a rotor at `turns` electrical turns.
std::uint8_t code_at(double turns) {
  return kCodes[static_cast<std::size_t>(std::floor((turns - std::floor(turns)) * 6.0 + 0.5)) % 6];
}

class Halls : public testing::Test {
 protected:
  explicit Halls(bool interpolated = false) { halls_.configure(false, interpolated, kSlowest); }
  /// Turns evenly; returns the largest difference of angle and rotor in degrees in the last turn.
  double turn(double from, double to, int periods) {
    double worst = 0.0;
    for (int k = 1; k <= periods; ++k) {
      const double turns = from + (to - from) * k / periods;
      halls_.step(code_at(turns), ++period_);
      const double error = halls_.angle(period_).value * (1.0 / 4294967296.0) - turns;
      if (std::fabs(to - turns) < 1.0) {
        worst = std::max(worst, std::fabs(error - std::round(error)) * 360.0);
      }
    }
    return worst;
  }
  HallDecoder halls_;
  std::uint32_t period_ = 0;
};

class InterpolatedHalls : public Halls {
 protected:
  InterpolatedHalls() : Halls(true) {}
};

TEST_F(Halls, EachCodeNamesTheMiddleOfItsSixth) {
  for (std::size_t n = 0; n < 6; ++n) {
    halls_.step(kCodes[n], ++period_);
    EXPECT_NEAR(degrees(halls_.angle(period_)), 60.0 * static_cast<double>(n), 1e-6);
    EXPECT_TRUE(halls_.valid());
  }
  EXPECT_FALSE(halls_.error());
}

TEST_F(Halls, CountSixStepsToAnElectricalTurnBothWays) {
  turn(0.0, 3.0, 600);
  EXPECT_EQ(halls_.position(), 18);
  turn(3.0, -2.0, 1000);
  EXPECT_EQ(halls_.position(), -12);
  EXPECT_FALSE(halls_.error());
}

TEST_F(Halls, WithoutInterpolationTheAngleIsWithin30Degrees) {
  const double worst = turn(0.0, 3.0, 3000);
  EXPECT_LE(worst, 30.5);
  EXPECT_GT(worst, 29.0);
}

TEST_F(Halls, InvertedSignalsAreTurnedBack) {
  halls_.configure(true, false, kSlowest);
  for (std::size_t n = 0; n < 6; ++n) {
    halls_.step(static_cast<std::uint8_t>(kCodes[n] ^ 7U), ++period_);
    EXPECT_NEAR(degrees(halls_.angle(period_)), 60.0 * static_cast<double>(n), 1e-6);
  }
  EXPECT_EQ(halls_.position(), 5);
}

TEST_F(Halls, AllLowAndAllHighAreErrorsThatKeepTheAngle) {
  for (const std::uint8_t impossible : {std::uint8_t{0b000}, std::uint8_t{0b111}}) {
    halls_.step(0b011, ++period_);
    halls_.step(impossible, ++period_);
    EXPECT_TRUE(halls_.error());
    EXPECT_FALSE(halls_.valid());
    EXPECT_NEAR(degrees(halls_.angle(period_)), 60.0, 1e-6);
    halls_.clear_error();
    EXPECT_TRUE(halls_.error()) << "it lasts";
    halls_.step(0b011, ++period_);
    halls_.clear_error();
    EXPECT_FALSE(halls_.error());
  }
}

TEST_F(Halls, ASkippedSixthIsAnErrorAndCounted) {
  halls_.step(kCodes[0], ++period_);
  halls_.step(kCodes[2], ++period_);
  EXPECT_TRUE(halls_.error());
  EXPECT_EQ(halls_.position(), 2);
  halls_.step(kCodes[0], ++period_);
  EXPECT_EQ(halls_.position(), 0);
}

TEST_F(Halls, AnOppositeCodeIsAnErrorWithoutDirection) {
  halls_.step(kCodes[1], ++period_);
  halls_.step(kCodes[4], ++period_);
  EXPECT_TRUE(halls_.error());
  EXPECT_EQ(halls_.position(), 0);
  EXPECT_NEAR(degrees(halls_.angle(period_)), 240.0, 1e-6);
}

TEST_F(InterpolatedHalls, AtConstantVelocityTheAngleIsWithinTwoPeriodsOfWay) {
  // 100 periods to a turn: 3.6 degrees a period.
  EXPECT_LT(turn(0.0, 5.0, 500), 2.0 * 3.6);
  EXPECT_LT(turn(5.0, 0.0, 500), 2.0 * 3.6) << "backward";
}

TEST_F(InterpolatedHalls, BelowTheThresholdTheMiddleIsKept) {
  turn(0.0, 3.0, 3 * 6 * 900);
  EXPECT_NEAR(degrees(halls_.angle(period_)), 0.0, 1e-6);
  EXPECT_GT(turn(3.0, 5.0, 2 * 6 * 900), 29.0);
}

TEST_F(InterpolatedHalls, AStandingShaftGetsTheMiddleBack) {
  turn(0.0, 3.0, 300);
  for (int k = 0; k < 25; ++k) {
    halls_.step(code_at(3.0), ++period_);
  }
  EXPECT_NEAR(degrees(halls_.angle(period_)), 30.0, 1e-5) << "waits at the end of the sixth";
  for (std::uint32_t k = 0; k < kSlowest; ++k) {
    halls_.step(code_at(3.0), ++period_);
  }
  EXPECT_NEAR(degrees(halls_.angle(period_)), 0.0, 1e-6);
}

TEST_F(InterpolatedHalls, AfterAReversalTheFirstSixthIsNotInterpolated) {
  turn(0.0, 3.0, 300);
  turn(3.0, 2.9, 10);
  EXPECT_NEAR(degrees(halls_.angle(period_)), 300.0, 1e-6);
}

TEST_F(Halls, TheMiddleOfASixthIsTheNearestAngleToIt) {
  for (std::size_t n = 0; n < 6; ++n) {
    halls_.step(kCodes[n], ++period_);
    const auto six_times = static_cast<std::int64_t>(halls_.angle(period_).value) * 6;
    EXPECT_LE(std::abs(six_times - static_cast<std::int64_t>(n) * 4'294'967'296), 3) << n;
  }
}

TEST_F(Halls, TakingTheSameParametersAgainLosesNoStep) {
  halls_.step(kCodes[0], ++period_);
  halls_.configure(false, false, kSlowest);
  halls_.step(kCodes[1], ++period_);
  EXPECT_EQ(halls_.position(), 1);
}

}  // namespace
}  // namespace stator::control
