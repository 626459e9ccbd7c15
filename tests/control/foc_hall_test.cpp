// Digital Hall sensors at the TMC8670's FOC block: sectors, interpolation, filter, blanking.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/control/foc/hall_decoder.hpp"

namespace stator::control::foc {
namespace {

std::uint8_t hall_levels(double angle) {
  unsigned levels = 0;
  for (int k = 0; k < 3; ++k) {
    levels |= static_cast<unsigned>(std::cos(angle - k * 2.0 * M_PI / 3.0) > 0.0) << k;
  }
  return static_cast<std::uint8_t>(levels);
}

constexpr PwmPeriod kQuiet{};

TEST(FocHall, ShowsTheMiddleOfEachSectorAndKeepsItThroughImpossibleLevels) {
  HallDecoder hall;
  hall.configure({});
  const std::array<std::uint8_t, 6> levels{1, 3, 2, 6, 4, 5};
  const std::array<std::int32_t, 6> angle{0, 10922, 21845, -32768, -21846, -10923};
  for (unsigned k = 0; k < 18; ++k) {
    hall.step(levels[k % 6], kQuiet, 4000);
    EXPECT_EQ(hall.phi_e(), angle[k % 6]);
    hall.step(k % 2 == 0 ? 0 : 7, kQuiet, 4000);
    EXPECT_EQ(hall.phi_e(), angle[k % 6]);
  }
}

TEST(FocHall, IsWithinThirtyDegreesOfTheRotor) {
  HallDecoder hall;
  hall.configure({});
  for (int k = 0; k < 100'000; ++k) {
    const double angle = k * 0.001;
    hall.step(hall_levels(angle), kQuiet, 4000);
    EXPECT_LE(std::fabs(std::remainder(hall.phi_e() / 65536.0 * 2.0 * M_PI - angle, 2.0 * M_PI)),
              M_PI / 6.0 + 0.0011);
  }
}

TEST(FocHall, PolarityDirectionOffsetAndPositionsAreAdjustable) {
  HallSettings settings;
  settings.inverted = true;
  settings.phi_e_offset = 1000;
  HallDecoder hall;
  hall.configure(settings);
  hall.step(6, kQuiet, 4000);  // inverted: 001
  hall.step(6, kQuiet, 4000);
  EXPECT_EQ(hall.phi_e(), 1000);
  hall.step(4, kQuiet, 4000);  // 011
  EXPECT_EQ(hall.phi_e(), 11922);
  settings.reversed = true;
  settings.position[1] = 12'000;
  hall.configure(settings);
  EXPECT_EQ(hall.phi_e(), -11'000);
}

TEST(FocHall, CountsRevolutionsForTheMechanicalAngle) {
  HallSettings settings;
  settings.pole_pairs = 3;
  HallDecoder hall;
  hall.configure(settings);
  for (const double turns : {0.0, 1.0 / 6.0, 0.5, 1.0, 2.5, 1.2, -0.6, -3.0}) {
    static double at = 0.0;
    const double way = turns < at ? -0.001 : 0.001;
    while (std::fabs(turns - at) > 0.0005) {
      at += way;
      hall.step(hall_levels(at * 2.0 * M_PI), kQuiet, 4000);
    }
    const double exact = turns / 3.0 * 65536.0;
    EXPECT_NEAR(std::remainder(hall.phi_m() - exact, 65536.0), 0.0, 65536.0 / 36.0 + 40.0) << turns;
  }
}

/// Largest error (1/65536 revolution) of the interpolated angle at `rpm` mechanical.
double interpolation_error(double rpm, std::int32_t pole_pairs, bool& active) {
  HallSettings settings;
  settings.interpolated = true;
  settings.pole_pairs = pole_pairs;
  HallDecoder hall;
  hall.configure(settings);
  const double per_period = rpm / 60.0 * pole_pairs * 2.0 * M_PI * 40e-6;
  const int revolution = static_cast<int>(2.0 * M_PI / std::fabs(per_period));
  double worst = 0.0;
  double angle = 1.0;
  for (int k = 0; k < 4 * revolution; ++k) {
    angle += per_period;
    hall.step(hall_levels(angle), kQuiet, 4000);
    if (k > 2 * revolution) {
      const double exact = angle / (2.0 * M_PI) * 65536.0;
      worst = std::max(worst, std::fabs(std::remainder(hall.phi_e_used() - exact, 65536.0)));
    }
  }
  active = hall.interpolating();
  return worst;
}

TEST(FocHall, InterpolatedAngleIsWithinAPeriodsTurnAboveSixtyRpm) {
  for (const double rpm : {61.0, 300.0, 3000.0, -61.0, -3000.0}) {
    bool active = false;
    const double turn = std::fabs(rpm) / 60.0 * 4 * 65536.0 * 40e-6;
    // One period late at the border, and as much in the time of the sector.
    EXPECT_LE(interpolation_error(rpm, 4, active), 2.1 * turn + 4.0) << rpm;
    EXPECT_TRUE(active);
  }
  bool active = true;
  EXPECT_GT(interpolation_error(59.0, 4, active), 5000.0);
  EXPECT_FALSE(active);
}

TEST(FocHall, InterpolationEndsAtItsLargestStepAndAtRest) {
  HallSettings settings;
  settings.interpolated = true;
  settings.largest_interpolation = 5000;
  HallDecoder hall;
  hall.configure(settings);
  const std::array<std::uint8_t, 6> levels{1, 3, 2, 6, 4, 5};
  for (unsigned k = 0; k < 60; ++k) {
    hall.step(levels[k / 10], kQuiet, 4000);
  }
  const std::int32_t border = hall.border();
  for (int k = 0; k < 100; ++k) {
    hall.step(5, kQuiet, 4000);
  }
  EXPECT_EQ(hall.phi_e_interpolated(), static_cast<std::int16_t>(border + 5000));
  for (int k = 0; k < 5000; ++k) {
    hall.step(5, kQuiet, 4000);
  }
  EXPECT_EQ(hall.phi_e_interpolated(), hall.phi_e());
}

TEST(FocHall, MisplacedSensorsFalsifyTheInterpolatedAngle) {
  HallSettings settings;
  settings.interpolated = true;
  HallDecoder hall;
  hall.configure(settings);
  double worst = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double angle = k * 0.02;
    unsigned levels = 0;
    for (int s = 0; s < 3; ++s) {
      const double place = s * 2.0 * M_PI / 3.0 + (s == 1 ? 0.3 : 0.0);
      levels |= static_cast<unsigned>(std::cos(angle - place) > 0.0) << s;
    }
    hall.step(static_cast<std::uint8_t>(levels), kQuiet, 4000);
    if (k > 1000) {
      const double exact = angle / (2.0 * M_PI) * 65536.0;
      worst = std::max(worst, std::fabs(std::remainder(hall.phi_e_used() - exact, 65536.0)));
    }
  }
  EXPECT_GT(worst, 0.2 / (2.0 * M_PI) * 65536.0);
}

TEST(FocHall, FilterPassesOnlyWhatStood) {
  HallSettings settings;
  settings.filter = 20;  // 100 us
  HallDecoder hall;
  hall.configure(settings);
  const auto step = [&](std::uint8_t levels, int periods) {
    for (int k = 0; k < periods; ++k) {
      hall.step(levels, kQuiet, 1000);  // 10 us
    }
  };
  step(1, 12);
  EXPECT_EQ(hall.filtered(), 1);
  for (int k = 0; k < 50; ++k) {  // bouncing
    step(3, 5);
    step(1, 5);
    EXPECT_EQ(hall.filtered(), 1);
  }
  step(3, 10);
  EXPECT_EQ(hall.filtered(), 1);
  step(3, 1);
  EXPECT_EQ(hall.filtered(), 3);
}

TEST(FocHall, BlankingLongerThanAnyCalmHoldsTheLevels) {
  HallSettings settings;
  settings.blanking = 1000;
  HallDecoder hall;
  hall.configure(settings);
  PwmPeriod pwm;
  pwm.half_bridges = 3;
  pwm.chopper = Chopper::centred;
  pwm.period = 4000;
  pwm.on_time = {2000, 2000, 2000};  // calm for 2000 ticks about begin and middle
  hall.step(1, pwm, 4000);
  EXPECT_EQ(hall.filtered(), 1);
  settings.blanking = 2000;
  hall.configure(settings);
  hall.step(3, pwm, 4000);
  EXPECT_EQ(hall.filtered(), 1);
  pwm.on_time = {1000, 2000, 3000};  // now at most 1000
  settings.blanking = 1001;
  hall.configure(settings);
  hall.step(3, pwm, 4000);
  EXPECT_EQ(hall.filtered(), 1);
  settings.blanking = 999;
  hall.configure(settings);
  hall.step(3, pwm, 4000);
  EXPECT_EQ(hall.filtered(), 3);
  pwm.chopper = Chopper::off;  // nothing switches
  settings.blanking = 4095;
  hall.configure(settings);
  hall.step(2, pwm, 4000);
  EXPECT_EQ(hall.filtered(), 2);
}

}  // namespace
}  // namespace stator::control::foc
