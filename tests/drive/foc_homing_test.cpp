// Homing as CiA 402-2 has it, on the axis with a FOC block: halt, errors, offset, and whatever
// stops a run in any of its stages.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

constexpr unsigned kReached = statusword::kTargetReached;
constexpr unsigned kAttained = statusword::kTargetReached | statusword::kHomeAttained;
constexpr unsigned kError = statusword::kHomingError;
constexpr double kStands = 20.0;  // rpm: a count of the encoder in a period of the velocity meter

/// A way on which every method finds its home within three turns.
plant::PwmAxisParameters track() {
  plant::PwmAxisParameters parameters = foc_plant();
  parameters.initial_revolutions = 0.3;
  parameters.load.end_stop_maximum = 2.5;
  return parameters;
}

class FocHomingBench : public FocBench {
 public:
  explicit FocHomingBench(int method = 17) : FocBench(track()) {
    left_switch = -1.5;
    axis->settings().hard_stop = {
        .current = 0.6, .positive_clearance = 16'384, .negative_clearance = 16'384};
    write(0x6099, 1, 300);
    write(0x6099, 2, method < 0 ? 200 : 60);
    write(0x609A, 4000);
    write(0x6085, 8000);
    write(0x6098, method);
  }
  void begin() {
    enable(ModeCode::homing);
    write(0x6040, 0x1F);
  }
  /// Bits 10, 12 and 13.
  [[nodiscard]] unsigned bits() const {
    return static_cast<unsigned>(read(0x6041)) & (kAttained | kError);
  }
  [[nodiscard]] bool attained(base::SimDuration longest = 10_s) {
    return pass_until([&] { return bits() == kAttained; }, longest);
  }
  /// Revolutions of the shaft where positions are 0.
  [[nodiscard]] double zero() const {
    return revolutions() - static_cast<double>(position()) / kTurn;
  }
};

class FocHomingByProfile : public testing::Test {
 protected:
  FocHomingBench bench_;
};

// Statusword and start

TEST_F(FocHomingByProfile, BitTenAloneTellsThatNoRunHasStarted) {
  bench_.enable(ModeCode::homing);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.bits(), kReached);
  bench_.write(0x6040, 0x1F);
  EXPECT_EQ(bench_.bits(), 0U) << "with the controlword that starts it";
  ASSERT_TRUE(bench_.attained());
}

TEST_F(FocHomingByProfile, ItStartsWhereBitFourRisesInItsModeOnly) {
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x6040, 0x1F);
  bench_.write(0x6060, 6);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.read(0x6061), 6);
  EXPECT_FALSE(bench_.axis->homing()) << "bit 4 was set before";
  EXPECT_NEAR(bench_.rpm(), 0.0, kStands);
  bench_.write(0x6040, 0x07);
  bench_.pass(5_ms);
  bench_.write(0x6040, 0x0F);
  bench_.pass(5_ms);
  bench_.write(0x6040, 0x1F);
  EXPECT_TRUE(bench_.axis->homing());
}

TEST_F(FocHomingByProfile, ARunLeftForAnotherModeIsOver) {
  bench_.enable(ModeCode::homing);
  bench_.write(0x6040, 0x1F);
  bench_.write(0x6060, 3);  // it has not moved yet
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.read(0x6061), 3);
  EXPECT_FALSE(bench_.axis->homing());
  bench_.write(0x6060, 6);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.revolutions(), 0.3, 0.02);
  EXPECT_EQ(bench_.bits(), kReached) << "interrupted";
}

// Errors

TEST_F(FocHomingByProfile, WhatKeepsAMethodFromStartingIsAHomingErrorWithItsReason) {
  struct Case {
    int method;
    std::uint16_t index;
    std::uint8_t subindex;
    const char* reason;
  };
  for (const Case& c :
       {Case{17, 0x6099, 1, "homing method 17 not started: 6099h is 0 and 60 rpm"},
        Case{17, 0x6099, 2, "homing method 17 not started: 6099h is 300 and 0 rpm"},
        Case{17, 0x609A, 0, "homing method 17 not started: 609Ah is 0"},
        Case{-1, 0x6099, 2, "homing method -1 not started: 6099h is 300 and 0 rpm"}}) {
    SCOPED_TRACE(c.reason);
    FocHomingBench bench(c.method);
    bench.write(c.index, c.subindex, 0);
    bench.begin();
    EXPECT_EQ(bench.bits() & kError, kError);
    bench.pass(100_ms);
    EXPECT_EQ(bench.bits(), kError | kReached) << "and the velocity is 0";
    EXPECT_TRUE(bench.told(c.reason));
    EXPECT_NEAR(bench.revolutions(), 0.3, 0.02);
  }
}

TEST_F(FocHomingByProfile, AMethodThatIsNotThereIsAHomingErrorAndForgetsTheRunBefore) {
  bench_.begin();
  ASSERT_TRUE(bench_.attained());
  for (const int method : {0, 4, 7, 8, 23, 30}) {
    bench_.write(0x6098, method);
    bench_.write(0x6040, 0x0F);
    EXPECT_NE(bench_.bits(), 0U) << "as it was";
    bench_.write(0x6040, 0x1F);
    EXPECT_NE(bench_.bits() & kError, 0U) << method;
    bench_.pass(50_ms);
    EXPECT_EQ(bench_.bits(), kError | kReached) << method;
    EXPECT_TRUE(bench_.told("homing not started: 6098h is " + std::to_string(method)));
  }
}

TEST_F(FocHomingByProfile, AnErrorIsForgottenByTheNextStartAndByTheNextEnabling) {
  bench_.write(0x609A, 0);
  bench_.begin();
  ASSERT_NE(bench_.bits() & kError, 0U);
  bench_.write(0x6040, 0x07);
  bench_.pass(5_ms);
  bench_.write(0x6040, 0x0F);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.bits(), kReached);
  bench_.write(0x6040, 0x1F);
  ASSERT_NE(bench_.bits() & kError, 0U);
  bench_.write(0x609A, 4000);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6040, 0x1F);
  EXPECT_EQ(bench_.bits(), 0U);
  EXPECT_TRUE(bench_.attained());
}

TEST_F(FocHomingByProfile, ALimitSwitchInTheWayIsAnErrorAtTheSpeedItHasThenAndAtNone) {
  bench_.right_switch = 1.0;
  bench_.write(0x6098, 3);
  bench_.begin();
  ASSERT_TRUE(bench_.pass_until([&] { return (bench_.bits() & kError) != 0; }, 2_s));
  EXPECT_EQ(bench_.bits(), kError) << "it still brakes";
  EXPECT_GT(bench_.rpm(), 200.0);
  bench_.pass(300_ms);
  EXPECT_EQ(bench_.bits(), kError | kReached);
  EXPECT_NEAR(bench_.rpm(), 0.0, kStands);
  EXPECT_TRUE(bench_.told("homing method 3 ended with a homing error: a limit switch"));
  EXPECT_FALSE(bench_.axis->homing());
}

TEST_F(FocHomingByProfile, ASearchThatMeetsBothLimitSwitchesHasFailed) {
  bench_.right_switch = 1.0;
  bench_.left_switch = -0.5;
  bench_.write(0x6098, 19);  // and there is no home switch
  bench_.begin();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.bits() == (kError | kReached); }, 10_s));
  EXPECT_LT(bench_.revolutions(), -0.4);
  EXPECT_TRUE(bench_.told("both limit switches were met"));
}

// Offset

TEST_F(FocHomingByProfile, ThePresentPositionBecomesTheHomeOffset) {
  for (const int method : {35, 37}) {
    for (const bool as_position : {false, true}) {
      FocHomingBench bench(method);
      bench.axis->settings().reference.home_offset_is_position = as_position;
      bench.write(0x607C, 1234);
      bench.begin();
      ASSERT_TRUE(bench.attained(100_ms));
      EXPECT_NEAR(static_cast<double>(bench.position()), as_position ? 1234.0 : -1234.0, 48.0);
      EXPECT_NEAR(bench.revolutions(), 0.3, 0.02);
    }
  }
}

TEST_F(FocHomingByProfile, ThePresentPositionIsNamedWhenTheMotorStands) {
  bench_.write(0x6098, 17);
  bench_.begin();
  bench_.pass(100_ms);
  ASSERT_LT(bench_.rpm(), -250.0);
  bench_.write(0x6098, 35);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x6040, 0x1F);
  EXPECT_EQ(bench_.bits(), 0U) << "it still turns";
  double at = 0.0;
  ASSERT_TRUE(bench_.pass_until(
      [&] {
        at = bench_.rpm();
        return bench_.bits() == kAttained;
      },
      1_s));
  EXPECT_NEAR(at, 0.0, kStands);
  const double named = bench_.revolutions();
  bench_.pass(500_ms);
  EXPECT_NEAR(bench_.revolutions(), named, 0.01);
  EXPECT_NEAR(static_cast<double>(bench_.position()), 0.0, 96.0);
}

TEST_F(FocHomingByProfile, ThePresentPositionNeedsNoPower) {
  bench_.write(0x6098, 37);
  bench_.write(0x6060, 6);
  bench_.write(0x6040, 0x10);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.bits(), kAttained);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
  EXPECT_EQ(bench_.position(), 0);
}

// A load that lags

TEST_F(FocHomingByProfile, AHeavyLoadIsNoHardStop) {
  plant::PwmAxisParameters parameters = track();
  parameters.load.inertia = 2e-4;
  FocBench bench(parameters);
  bench.block.set(control::foc::field("PID_VELOCITY_P"), 8200);  // as such a load is tuned
  bench.axis->settings().hard_stop = {
      .current = 0.6, .positive_clearance = 16'384, .negative_clearance = 16'384};
  bench.write(0x6099, 2, 60);
  bench.write(0x609A, 100'000);
  bench.write(0x6098, -1);
  bench.enable(ModeCode::homing);
  bench.write(0x6040, 0x1F);
  ASSERT_TRUE(bench.pass_until([&] { return bench.status(statusword::kHomeAttained); }, 60_s));
  EXPECT_NEAR(bench.revolutions() - static_cast<double>(bench.position()) / FocBench::kTurn, 2.25,
              0.03);
}

TEST_F(FocHomingByProfile, AnEdgeDoesNotCountForARampThatIsSlowWhileTheShaftIsNot) {
  plant::PwmAxisParameters parameters = track();
  parameters.load.inertia = 2e-4;
  FocBench bench(parameters);
  bench.block.set(control::foc::field("PID_VELOCITY_P"), 8200);
  bench.home_switch = {1.0, 1.1};  // passed in both directions while the shaft turns round
  bench.write(0x6099, 1, 300);
  bench.write(0x6099, 2, 60);
  bench.write(0x609A, 100'000);
  bench.write(0x6098, 19);
  bench.enable(ModeCode::homing);
  bench.write(0x6040, 0x1F);
  ASSERT_TRUE(bench.pass_until([&] { return bench.status(statusword::kHomeAttained); }, 20_s));
  EXPECT_NEAR(bench.revolutions() - static_cast<double>(bench.position()) / FocBench::kTurn, 1.0,
              0.003);
}

TEST_F(FocHomingByProfile, HomeIsReachedWhereTheShaftIs) {
  bench_.write(0x6099, 2, 200);
  bench_.begin();
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x606B) > 150; }, 5_s));
  ASSERT_TRUE(bench_.pass_until([&] { return bench_.read(0x606B) < 0; }, 5_s)) << "it goes back";
  plant::PwmAxisFaults jam;
  jam.common.shaft.jamming_torque = 1.0;
  bench_.plant.set_faults(jam);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.bits(), 0U) << "the shaft stands in front of home";
  bench_.plant.set_faults({});
  ASSERT_TRUE(bench_.attained());
  EXPECT_NEAR(bench_.zero(), -1.5, 0.003);
}

}  // namespace
}  // namespace stator::drive
