// An axis of CiA 402 with ramp and encoder: option codes, following errors, cyclic modes, limits,
// homing.
#include <gtest/gtest.h>

#include "drive/axis_bench.hpp"
#include "stator/drive/power/control_words.hpp"
#include "stator/drive/stepper/stepper_axis.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;

constexpr int kCsp = 8;
constexpr int kCsv = 9;

class AxisTest : public testing::Test {
 protected:
  void run_at(double velocity) {
    bench_.set_profile(0, 20'000, 40'000);
    bench_.enable(ModeCode::profile_velocity);
    bench_.write(0x60FF, static_cast<std::int64_t>(velocity));
    bench_.pass(1_s);
    ASSERT_EQ(bench_.velocity(), velocity);
  }
  AxisBench bench_;
};

// Quick stop, disable operation, faults

TEST_F(AxisTest, QuickStopOptionsChooseRampAndFinalState) {
  struct Case {
    int option;
    double velocity_after_100_ms;  // from 10000 with 6084h = 40000 or 6085h = 80000
    PowerState end;
  };
  for (const Case& c : {Case{1, 6000.0, PowerState::switch_on_disabled},
                        Case{2, 2000.0, PowerState::switch_on_disabled},
                        Case{5, 6000.0, PowerState::quick_stop_active},
                        Case{6, 2000.0, PowerState::quick_stop_active}}) {
    bench_.write(0x6040, 0);
    bench_.write(0x605A, c.option);
    bench_.write(0x6085, 80'000);
    run_at(10'000.0);
    bench_.write(0x6040, 0x0002);
    EXPECT_EQ(bench_.axis->power_state(), PowerState::quick_stop_active);
    bench_.pass(100_ms);
    EXPECT_NEAR(bench_.velocity(), c.velocity_after_100_ms, 0.1) << "option " << c.option;
    bench_.pass(200_ms);
    EXPECT_EQ(bench_.velocity(), 0.0);
    EXPECT_EQ(bench_.axis->power_state(), c.end) << "option " << c.option;
    EXPECT_EQ(bench_.actuation.bridge_enabled, c.end == PowerState::quick_stop_active);
  }
}

TEST_F(AxisTest, AfterQuickStopOption6EnableOperationResumes) {
  bench_.write(0x605A, 6);
  run_at(10'000.0);
  bench_.write(0x6040, 0x0002);
  bench_.pass(1_s);
  bench_.write(0x6040, 0x000F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 10'000.0) << "60FFh is still there";
}

TEST_F(AxisTest, DisableOperationSlowsDownFirst) {
  run_at(10'000.0);
  bench_.write(0x6040, 0x0007);
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.velocity(), 6000.0, 0.1);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switched_on);
}

TEST_F(AxisTest, ShutdownSwitchesOffWithoutARamp) {
  run_at(10'000.0);
  bench_.write(0x6040, 0x0006);
  EXPECT_EQ(bench_.velocity(), 0.0);
  bench_.pass(1_ms);
  EXPECT_FALSE(bench_.actuation.bridge_enabled);
}

TEST_F(AxisTest, LeavingOperationalStopsOnTheQuickStopRampAndDisablesTheDrive) {
  run_at(10'000.0);
  bench_.axis->network_left_operational(bench_.now);
  EXPECT_FALSE(bench_.status(statusword::kRemote));
  bench_.pass(100_ms);
  EXPECT_NEAR(bench_.velocity(), 10'000.0 - 5120.0, 0.1) << "6085h = 51200";
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
}

TEST_F(AxisTest, AFollowingErrorBrakesIntoFaultAndIsReset) {
  bench_.write(0x606A, 0);
  bench_.write(0x6065, 500);
  run_at(10'000.0);
  bench_.blocked = true;
  bench_.pass(49_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.pass(3_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault_reaction_active);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::following_error));
  ASSERT_FALSE(bench_.sentences.empty());
  EXPECT_NE(bench_.sentences.back().find("following error"), std::string::npos);
  bench_.pass(100_ms);
  EXPECT_LT(bench_.velocity(), 10'000.0) << "on the quick-stop ramp";
  EXPECT_GT(bench_.velocity(), 0.0);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::fault);
  EXPECT_FALSE(bench_.actuation.bridge_enabled);

  bench_.blocked = false;
  bench_.write(0x60FF, 0);
  bench_.write(0x6040, 0x0080);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::switch_on_disabled);
  EXPECT_TRUE(bench_.axis->errors().empty());
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(10_ms);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled)
      << "the demand starts from the encoder";
  EXPECT_EQ(bench_.read(0x6062), bench_.read(0x6064));
}

TEST_F(AxisTest, WithoutAnEncoderThereIsNoFollowingError) {
  bench_.write(0x6065, 1);
  bench_.blocked = true;
  run_at(10'000.0);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(AxisTest, AFollowingErrorSetsBit13InCyclicPositionOnly) {
  bench_.write(0x606A, 0);
  bench_.write(0x6065, 500);
  bench_.enable(static_cast<ModeCode>(kCsp));
  bench_.blocked = true;
  bench_.write(0x607A, 1000);
  bench_.pass(5_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::following_error));
  EXPECT_TRUE(bench_.status(statusword::kFollowingError));
  bench_.write(0x6060, 1);
  EXPECT_FALSE(bench_.status(statusword::kFollowingError));
}

// Cyclic modes

TEST_F(AxisTest, CyclicPositionInterpolatesOverThePeriodAndHolds) {
  bench_.write(0x60C2, 1, 4);  // 4 ms
  bench_.enable(static_cast<ModeCode>(kCsp));
  EXPECT_TRUE(bench_.status(statusword::kTargetUsed));
  bench_.write(0x607A, 400);
  bench_.pass(1_ms);
  EXPECT_NEAR(bench_.position(), 100.0, 1e-6);
  EXPECT_NEAR(bench_.velocity(), 100'000.0, 1e-6);
  bench_.pass(3_ms);
  EXPECT_NEAR(bench_.position(), 400.0, 1e-6);
  bench_.pass(10_ms);
  EXPECT_EQ(bench_.position(), 400.0) << "no new target: hold";
  EXPECT_FALSE(bench_.status(statusword::kTargetReached)) << "reserved in csp";
}

TEST_F(AxisTest, CyclicPositionFollowsAStreamWithoutLag) {
  bench_.enable(static_cast<ModeCode>(kCsp));
  for (int k = 1; k <= 1000; ++k) {
    bench_.place(0x607A, 10 * k);
    bench_.axis->apply(bench_.now);
    bench_.pass(1_ms);
    EXPECT_NEAR(bench_.position(), 10.0 * k, 1e-6);
    EXPECT_NEAR(bench_.velocity(), 10'000.0, 1e-3);
  }
}

TEST_F(AxisTest, CyclicPositionAddsTheOffsetBeforeTheLimit) {
  bench_.write(0x607D, 2, 1000);
  bench_.write(0x60B0, 250);
  bench_.enable(static_cast<ModeCode>(kCsp));
  bench_.write(0x607A, 100);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.position(), 350.0);
  bench_.write(0x607A, 900);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.position(), 1000.0);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  bench_.write(0x607A, 2'147'483'647);
  bench_.pass(5_ms);
  EXPECT_EQ(bench_.position(), 1000.0) << "the sum does not wrap at 32 bits";
}

TEST_F(AxisTest, CyclicPositionPassesTheEndOfThe32BitCounter) {
  bench_.write(0x607A, 2'147'483'000);
  bench_.write(0x60C2, 2, 3);  // 1000 s, nothing jumps meanwhile
  bench_.enable(static_cast<ModeCode>(kCsp));
  bench_.write(0x60C2, 2, -3);
  bench_.write(0x607A, 2'147'483'600);
  bench_.pass(2_ms);
  ASSERT_EQ(bench_.read(0x6062), 2'147'483'600);
  bench_.write(0x607A, -2'147'483'600);
  bench_.pass(2_ms);
  EXPECT_EQ(bench_.read(0x6062), -2'147'483'600);
  EXPECT_EQ(bench_.axis->motion().position(), 2'147'483'696) << "96 microsteps on, not back";
}

TEST_F(AxisTest, CyclicVelocityReachesItsTargetWithinThePeriodAndKeepsIt) {
  bench_.write(0x60C2, 1, 10);
  bench_.enable(static_cast<ModeCode>(kCsv));
  bench_.write(0x60B1, 500);
  bench_.write(0x60FF, 1500);
  bench_.pass(5_ms);
  EXPECT_NEAR(bench_.velocity(), 1000.0, 1.0);
  bench_.pass(6_ms);
  EXPECT_NEAR(bench_.velocity(), 2000.0, 1e-9);
  bench_.pass(1_s);
  EXPECT_NEAR(bench_.velocity(), 2000.0, 1e-9) << "no new target: keep";
  EXPECT_TRUE(bench_.status(statusword::kTargetUsed));
  bench_.write(0x6040, 0x010F);
  EXPECT_FALSE(bench_.status(statusword::kTargetUsed)) << "halt";
}

TEST_F(AxisTest, CyclicVelocityStopsAtASoftwareLimit) {
  bench_.write(0x607D, 1, -3000);
  bench_.set_profile(0, 0, 40'000);
  bench_.enable(static_cast<ModeCode>(kCsv));
  bench_.write(0x60FF, -5000);
  bench_.pass(5_s);
  EXPECT_EQ(bench_.position(), -3000.0);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
}

TEST_F(AxisTest, HaltInACyclicModeWithoutDecelerationStopsAtOnce) {
  bench_.enable(static_cast<ModeCode>(kCsv));
  bench_.write(0x60FF, 5000);
  bench_.pass(10_ms);
  bench_.write(0x6040, 0x010F);
  EXPECT_EQ(bench_.velocity(), 0.0);
}

// Modes

TEST_F(AxisTest, ModeZeroStopsTheMotorOnTheRampOfTheOldMode) {
  run_at(10'000.0);
  bench_.write(0x6060, 0);
  EXPECT_EQ(bench_.read(0x6061), 3) << "the old mode is in force until the motor stands";
  bench_.pass(125_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1);
  bench_.pass(200_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_EQ(bench_.read(0x6061), 0);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
}

TEST_F(AxisTest, ANewModeTakesOverWhenTheMotorStands) {
  run_at(10'000.0);
  bench_.set_profile(10'000, 20'000, 40'000);
  bench_.write(0x6060, 1);
  bench_.pass(500_ms);
  EXPECT_EQ(bench_.read(0x6061), 1);
  EXPECT_EQ(bench_.velocity(), 0.0);
  bench_.write(0x607A, 100);
  bench_.write(0x6040, 0x1F);
  bench_.pass(5_s);
  EXPECT_EQ(bench_.position(), 100.0);
}

TEST_F(AxisTest, TorqueModeAndUnmovingHomingMethodsKeepTheMotorStill) {
  for (const int mode : {6, 10}) {
    bench_.write(0x6098, mode == 6 ? 19 : 0);
    bench_.enable(static_cast<ModeCode>(mode));
    EXPECT_EQ(bench_.read(0x6061), mode);
    bench_.write(0x6040, 0x1F);
    bench_.pass(1_s);
    EXPECT_EQ(bench_.position(), 0.0);
    EXPECT_FALSE(bench_.status(statusword::kTargetReached));
    EXPECT_FALSE(bench_.status(statusword::kHomeAttained));
    bench_.write(0x6040, 0);
  }
}

TEST_F(AxisTest, Homing35MakesThePresentPositionZeroInAnyState) {
  run_at(10'000.0);
  bench_.write(0x6040, 0);
  ASSERT_NE(bench_.read(0x6064), 0);
  bench_.write(0x6060, 6);
  bench_.write(0x6098, 35);
  bench_.write(0x6040, 0x0010);
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x6062), 0);
  EXPECT_EQ(bench_.read(0x6063), 0);
  EXPECT_EQ(bench_.read(0x6064), 0);
  EXPECT_TRUE(bench_.status(statusword::kHomeAttained));
  EXPECT_TRUE(bench_.status(statusword::kTargetReached));
}

// Limits

TEST_F(AxisTest, SoftwareLimitsAreCorrectedByTheHomeOffset) {
  bench_.write(0x607D, 1, -1000);
  bench_.write(0x607D, 2, 100'000);
  bench_.write(0x607C, 2000);
  EXPECT_EQ(bench_.axis->motion().lower_limit(), -3000);
  EXPECT_EQ(bench_.axis->motion().upper_limit(), 98'000);
  bench_.set_profile(100'000, 1'000'000, 1'000'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, -5000);
  bench_.write(0x6040, 0x1F);
  bench_.pass(2_s);
  EXPECT_EQ(bench_.position(), -3000.0);
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_TRUE(bench_.status(statusword::kTargetReached)) << "of the clamped target";
}

TEST_F(AxisTest, DefaultLimitsMinusAnOffsetDoNotOverflow) {
  bench_.write(0x607C, 1'000'000);
  EXPECT_FALSE(bench_.axis->motion().lower_limit().has_value());
  bench_.write(0x607D, 1, -2'147'483'647);
  EXPECT_EQ(bench_.axis->motion().lower_limit(), -2'147'483'648) << "the end of the counter";
  EXPECT_EQ(bench_.axis->motion().upper_limit(), 2'147'483'647);
}

TEST_F(AxisTest, LeavingTheSoftwareLimitsIsReportedOnce) {
  bench_.set_profile(10'000, 100'000, 100'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, 5000);
  bench_.write(0x6040, 0x1F);
  bench_.pass(2_s);
  bench_.write(0x607D, 2, 1000);  // the axis now stands outside
  bench_.pass(10_ms);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::positive_software_limit));
  EXPECT_EQ(bench_.sentences.size(), 1U);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.sentences.size(), 1U);
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled) << "no fault";
  bench_.write(0x6040, 0x0F);
  bench_.write(0x607A, 0);
  bench_.write(0x6040, 0x1F);
  bench_.pass(2_s);
  EXPECT_TRUE(bench_.axis->errors().empty());
}

TEST_F(AxisTest, ALimitSwitchStopsHardAndBlocksItsDirectionOnly) {
  run_at(10'000.0);
  bench_.axis->conditions().positive_limit_switch = true;
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  EXPECT_TRUE(bench_.axis->errors().has(AxisError::positive_limit_switch));
  EXPECT_TRUE(bench_.status(statusword::kInternalLimit));
  EXPECT_EQ(bench_.axis->power_state(), PowerState::operation_enabled);
  bench_.write(0x60FF, 5000);
  bench_.pass(100_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
  bench_.write(0x60FF, -5000);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), -5000.0);
}

TEST_F(AxisTest, ALimitSwitchUsesTheStopDecelerationIfThereIsOne) {
  bench_.axis->settings().ramp.stop_deceleration = 100'000.0;
  run_at(10'000.0);
  bench_.axis->conditions().positive_limit_switch = true;
  bench_.pass(51_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 100.0);
  bench_.pass(60_ms);
  EXPECT_EQ(bench_.velocity(), 0.0);
}

TEST_F(AxisTest, APositioningIntoAPressedLimitSwitchDoesNotStart) {
  bench_.axis->conditions().negative_limit_switch = true;
  bench_.set_profile(10'000, 100'000, 100'000);
  bench_.enable(ModeCode::profile_position);
  bench_.write(0x607A, -100);
  bench_.write(0x6040, 0x1F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 0.0);
  bench_.write(0x6040, 0x0F);
  bench_.write(0x607A, 100);
  bench_.write(0x6040, 0x1F);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.position(), 100.0);
}

// Feedback and current

TEST_F(AxisTest, EncoderCountsAreScaledToMicrosteps) {
  PositionFeedback feedback;
  feedback.set_scale(40'000, 51'200, false);
  feedback.update(10'000, 1_ms);
  EXPECT_EQ(feedback.position(), 12'800);
  feedback.update(-1, 1_ms);
  EXPECT_EQ(feedback.position(), -1);
  feedback.update(-40'000'000'000, 1_ms);
  EXPECT_EQ(feedback.position(), -51'200'000'000);
  feedback.set_scale(40'000, 51'200, true);
  EXPECT_EQ(feedback.position(), 51'200'000'000);
  feedback.set_position(7);
  EXPECT_EQ(feedback.position(), 7);
}

TEST_F(AxisTest, EncoderVelocityIsTheMeanOfTheLastPeriods) {
  PositionFeedback feedback;
  feedback.set_scale(40'000, 51'200, false);
  for (int k = 0; k <= 40; ++k) {
    feedback.update(20 * k, 1_ms);  // half a revolution per second
  }
  EXPECT_NEAR(feedback.velocity(), 25'600.0, 1e-6);
}

TEST_F(AxisTest, WithTheEncoderInUseDemandStartsAtItsPosition) {
  run_at(10'000.0);
  bench_.write(0x6040, 0);
  bench_.pass(1_ms);
  const std::int64_t shaft = bench_.read(0x6064);
  bench_.axis->settings().position_from_encoder = true;
  bench_.write(0x606A, 0);
  bench_.axis->initialise_position();
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x6062), bench_.read(0x6064));
  EXPECT_EQ(bench_.read(0x6064), shaft) << "the ideal encoder has counted every microstep";
}

TEST_F(AxisTest, CurrentFollowsRunBoostAndStandbySettings) {
  control::CoilCurrentSettings& currents = bench_.axis->stepper_settings().currents;
  currents = {.run = 128, .standby = 8, .boost = 255, .standby_delay = 100_ms};
  bench_.axis->stepper_settings().full_scale_current = 3.2;
  const auto amplitude = [this] {
    const auto& target = bench_.actuation.coil_current_target;
    return target[0] * target[0] + target[1] * target[1];
  };
  bench_.set_profile(0, 10'000, 10'000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.pass(50_ms);
  EXPECT_NEAR(amplitude(), 1.7 * 1.7, 0.05) << "run: 17/32 of 3.2 A";
  bench_.pass(100_ms);
  EXPECT_NEAR(amplitude(), 0.2 * 0.2, 0.01) << "standby: 2/32";
  bench_.write(0x60FF, 10'000);
  bench_.pass(500_ms);
  EXPECT_NEAR(amplitude(), 3.2 * 3.2, 0.2) << "boost while accelerating";
  bench_.pass(1_s);
  EXPECT_NEAR(amplitude(), 1.7 * 1.7, 0.1) << "run at constant velocity";
}

TEST_F(AxisTest, VelocityAndAccelerationUnitsAreConvertedInOnePlace) {
  bench_.axis->settings().units = MotionUnits::internal();
  bench_.set_profile(0, 4 * 20'000, 4 * 40'000);
  bench_.enable(ModeCode::profile_velocity);
  bench_.write(0x60FF, 256 * 10'000);
  bench_.pass(250_ms);
  EXPECT_NEAR(bench_.velocity(), 5000.0, 0.1);
  bench_.pass(1_s);
  EXPECT_EQ(bench_.velocity(), 10'000.0);
  EXPECT_EQ(bench_.read(0x606C), 256 * 10'000);
}

TEST_F(AxisTest, TheStatuswordShowsVoltageRemoteAndState) {
  bench_.pass(1_ms);
  EXPECT_EQ(bench_.read(0x6041) & 0x024F, 0x0240) << "remote, Switch on disabled";
  EXPECT_TRUE(bench_.status(statusword::kVoltageEnabled));
  bench_.supply_voltage(5.0);
  bench_.axis->conditions().network_operational = false;
  bench_.pass(1_ms);
  EXPECT_FALSE(bench_.status(statusword::kVoltageEnabled));
  EXPECT_FALSE(bench_.status(statusword::kRemote));
}

TEST_F(AxisTest, StepsOfBothDirectionsAreCounted) {
  bench_.set_profile(10'000, 100'000, 100'000);
  bench_.enable(ModeCode::profile_position);
  for (const int target : {1000, 0}) {
    bench_.write(0x607A, target);
    bench_.write(0x6040, 0x1F);
    bench_.pass(1_s);
    bench_.write(0x6040, 0x0F);
  }
  EXPECT_EQ(bench_.axis->step_count(), 2000U);
}

}  // namespace
}  // namespace stator::drive
