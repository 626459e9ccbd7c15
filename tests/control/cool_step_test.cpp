// CoolStep: how StallGuard2 measurements raise and lower the coil current.
#include "stator/control/stepper/cool_step.hpp"

#include <array>
#include <utility>

#include <gtest/gtest.h>

namespace stator::control {
namespace {

constexpr std::uint8_t kRun = 255;  // current scale 31

void measure(CoolStep& cool_step, const CoolStepSettings& settings, int value, int times) {
  for (int n = 0; n < times; ++n) {
    cool_step.measured(settings, kRun, value);
  }
}

TEST(CoolStep, ThresholdsAreMultiplesOf32) {
  const CoolStepSettings settings{.hysteresis = 2, .hysteresis_start = 5};
  EXPECT_EQ(settings.lower_threshold(), 160);
  EXPECT_EQ(settings.upper_threshold(), 256);
}

TEST(CoolStep, HighMeasurementsTakeOneStepEach32_8_2_1) {
  constexpr std::array<int, 4> kMeasurements{32, 8, 2, 1};
  for (std::uint8_t down = 0; down < 4; ++down) {
    const CoolStepSettings settings{.down_step = down, .hysteresis_start = 5};
    CoolStep cool_step;
    measure(cool_step, settings, 500, kMeasurements[down] - 1);
    EXPECT_EQ(cool_step.reduction(), 0) << int{down};
    measure(cool_step, settings, 500, 1);
    EXPECT_EQ(cool_step.reduction(), 1) << int{down};
    measure(cool_step, settings, 500, kMeasurements[down]);
    EXPECT_EQ(cool_step.reduction(), 2) << int{down};
  }
}

TEST(CoolStep, LowMeasurementsGiveBack1_2_4_8Steps) {
  constexpr std::array<int, 4> kSteps{1, 2, 4, 8};
  for (std::uint8_t up = 0; up < 4; ++up) {
    const CoolStepSettings settings{.down_step = 3, .up_step = up, .hysteresis_start = 5};
    CoolStep cool_step;
    measure(cool_step, settings, 500, 12);
    ASSERT_EQ(cool_step.reduction(), 12);
    measure(cool_step, settings, 100, 1);
    EXPECT_EQ(cool_step.reduction(), 12 - kSteps[up]) << int{up};
    measure(cool_step, settings, 100, 20);
    EXPECT_EQ(cool_step.reduction(), 0) << "never above the run current";
  }
}

TEST(CoolStep, BetweenTheThresholdsNothingChanges) {
  const CoolStepSettings settings{.down_step = 3, .hysteresis = 2, .hysteresis_start = 5};
  CoolStep cool_step;
  measure(cool_step, settings, 257, 4);
  ASSERT_EQ(cool_step.reduction(), 4);
  measure(cool_step, settings, 256, 100);
  measure(cool_step, settings, 160, 100);
  EXPECT_EQ(cool_step.reduction(), 4);
  measure(cool_step, settings, 159, 1);
  EXPECT_EQ(cool_step.reduction(), 3);
}

TEST(CoolStep, HighMeasurementsMustFollowOneAnother) {
  const CoolStepSettings settings{.down_step = 1, .hysteresis = 2, .hysteresis_start = 5};
  CoolStep cool_step;
  for (int n = 0; n < 10; ++n) {
    measure(cool_step, settings, 500, 7);
    measure(cool_step, settings, 200, 1);
  }
  EXPECT_EQ(cool_step.reduction(), 0);
}

TEST(CoolStep, TheFloorIsHalfOrAQuarterOfTheRunCurrent) {
  for (const auto& [minimum, lowest] : {std::pair{0, 15}, std::pair{1, 7}}) {
    const CoolStepSettings settings{
        .minimum = static_cast<std::uint8_t>(minimum), .down_step = 3, .hysteresis_start = 5};
    CoolStep cool_step;
    measure(cool_step, settings, 1000, 100);
    EXPECT_EQ(31 - cool_step.reduction(), lowest);
  }
}

}  // namespace
}  // namespace stator::control
