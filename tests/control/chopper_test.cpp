#include "stator/control/stepper/chopper.hpp"

#include <gtest/gtest.h>

namespace stator::control {
namespace {

/// A standing motor at 3 A and 24 V; 1/248 of 3 A per converter step.
constexpr ChopperLoad kLoad{.current = 3.0, .converter_step = 3.0 / 248.0};
constexpr double kOn = (24.0 - 2.4) / 2.1e-3;    // A/s
constexpr double kSlow = 2.4 / 2.1e-3;           // A/s
constexpr double kFast = (24.0 + 2.4) / 2.1e-3;  // A/s

TEST(Chopper, SpreadCycleSpansTheHysteresisAndTheOffTimes) {
  // A hysteresis without decrement: its width above and below the target.
  const ChopperSettings settings{
      .blank_time = 0, .hysteresis_end = 8, .hysteresis_start = 0, .off_time = 3};
  const double hysteresis = 8 * 3.0 / 248.0;
  const double off = (12 + 32 * 3) / 16e6;
  const ChopperCycle cycle = chopper_cycle(settings, kLoad);
  const double ripple = 2.0 * hysteresis + kSlow * off;  // the second decay goes below the band
  EXPECT_NEAR(cycle.ripple, ripple, 1e-12);
  const double on = ripple / kOn;
  const double fast = (2.0 * hysteresis - kSlow * off) / kFast;
  EXPECT_NEAR(cycle.frequency, 1.0 / (on + fast + 2.0 * off), 1e-6);
}

TEST(Chopper, ALongerOffTimeLowersTheFrequency) {
  double before = 1e9;
  for (std::uint8_t off_time = 2; off_time <= 15; ++off_time) {
    ChopperSettings settings;
    settings.off_time = off_time;
    const double frequency = chopper_cycle(settings, kLoad).frequency;
    EXPECT_LT(frequency, before) << int{off_time};
    before = frequency;
  }
  EXPECT_GT(before, 5e3);
}

TEST(Chopper, HysteresisStartAndEndWidenTheRipple) {
  double before = 0.0;
  for (std::uint8_t start = 0; start <= 8; ++start) {
    const double ripple =
        chopper_cycle({.blank_time = 0, .hysteresis_end = 4, .hysteresis_start = start}, kLoad)
            .ripple;
    EXPECT_GE(ripple, before);
    before = ripple;
  }
  const double narrow = chopper_cycle({.blank_time = 0, .hysteresis_end = 2}, kLoad).ripple;
  const double wide = chopper_cycle({.blank_time = 0, .hysteresis_end = 12}, kLoad).ripple;
  EXPECT_GT(wide, narrow + 10 * 3.0 / 248.0);
}

TEST(Chopper, ASlowerDecrementLeavesMoreOfTheHysteresisStart) {
  double before = 0.0;
  for (std::uint8_t decrement = 0; decrement <= 3; ++decrement) {
    const double ripple = chopper_cycle({.blank_time = 0,
                                         .hysteresis_decrement = decrement,
                                         .hysteresis_end = 0,
                                         .hysteresis_start = 8},
                                        kLoad)
                              .ripple;
    EXPECT_GT(ripple, before) << int{decrement};
    before = ripple;
  }
}

TEST(Chopper, NoOnPhaseIsShorterThanTheBlankTime) {
  // With a negative hysteresis nothing but the blank time keeps the bridge on.
  double before = 0.0;
  for (std::uint8_t blank = 0; blank <= 3; ++blank) {
    const ChopperSettings settings{
        .blank_time = blank, .hysteresis_end = -3, .hysteresis_start = 0, .off_time = 2};
    const ChopperCycle cycle = chopper_cycle(settings, kLoad);
    EXPECT_GE(cycle.ripple, kOn * settings.blank_seconds() - 1e-12);
    EXPECT_GT(cycle.ripple, before) << int{blank};
    before = cycle.ripple;
  }
}

TEST(Chopper, TheClassicChopperIsOffForTheOffTime) {
  const ChopperSettings settings{.blank_time = 0, .constant_off_time = true, .off_time = 15};
  const double off = (12 + 32 * 15) / 16e6;
  const ChopperCycle cycle = chopper_cycle(settings, kLoad);
  EXPECT_NEAR(cycle.ripple, kSlow * off, 1e-12);
  EXPECT_NEAR(cycle.frequency, 1.0 / (off + kSlow * off / kOn), 1e-6);
}

TEST(Chopper, NothingIsChoppedWithOffTimeZeroOrWithoutVoltage) {
  EXPECT_EQ(chopper_cycle({.off_time = 0}, kLoad).frequency, 0.0);
  ChopperLoad dead = kLoad;
  dead.supply = 1.0;
  EXPECT_EQ(chopper_cycle({}, dead).frequency, 0.0);
}

}  // namespace
}  // namespace stator::control
